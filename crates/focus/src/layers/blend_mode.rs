//! How a layer of focus is blended with the layers below it.

use serde::{Deserialize, Serialize};

/// How a layer is blended with what lies below it. `w` is the layer's weight in [0, 1] (opacity times mask); at w = 0
/// nothing changes. Symbols as in the optics: κ = (t − 1)/d + t(1 − a)(1/s − 1/z).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BlendMode {
    /// t, anchor and gloss each move toward the layer's values.
    #[default]
    Set,
    /// The defocus κ moves toward the layer's, in proportion at every depth: (t − 1) and t(1 − a) each move, and so
    /// does gloss.
    Mix,
    /// The layer's t − 1, anchor and gloss are added.
    Add,
    /// The defocus κ is multiplied by the layer's t (0 makes sharp, 1 changes nothing, 2 doubles). The lens's own
    /// share cannot grow (the anchor would leave [0, 1]); only the painted share can. Gloss stays.
    MultiplyDefocus,
}

impl BlendMode {
    /// All modes, in the order in which a menu offers them.
    pub const ALL: [Self; 4] = [Self::Set, Self::Mix, Self::Add, Self::MultiplyDefocus];

    /// Blends a layer's [t, anchor] with the values `beneath`, with the weight `w` in [0, 1].
    pub fn blend(self, beneath: [f32; 2], layer: [f32; 2], w: f32) -> [f32; 2] {
        if w <= 0.0 {
            return beneath;
        }
        let ([t0, a0], [t1, a1]) = (beneath, layer);
        let between = |from: f32, to: f32| if w >= 1.0 { to } else { from + (to - from) * w };
        match self {
            Self::Set => [between(t0, t1), between(a0, a1)],
            Self::Mix if w >= 1.0 => layer,
            Self::Mix => with_lens_part(between(t0, t1), between(t0 * (1.0 - a0), t1 * (1.0 - a1)), a0),
            Self::Add => [t0 + w * (t1 - 1.0), (a0 + w * a1).clamp(0.0, 1.0)],
            Self::MultiplyDefocus => {
                let factor = between(1.0, t1);
                if factor == 1.0 {
                    return beneath;
                }
                with_lens_part(1.0 + factor * (t0 - 1.0), factor * t0 * (1.0 - a0), a0)
            }
        }
    }

    /// Blends a layer's gloss with the gloss `beneath`, both in [0, 1], with the weight `w` in [0, 1].
    pub fn blend_gloss(self, beneath: f32, layer: f32, w: f32) -> f32 {
        match self {
            _ if w <= 0.0 => beneath,
            Self::Set | Self::Mix if w >= 1.0 => layer,
            Self::Set | Self::Mix => beneath + (layer - beneath) * w,
            Self::Add => (beneath + w * layer).clamp(0.0, 1.0),
            Self::MultiplyDefocus => beneath,
        }
    }
}

/// [t, anchor] for given t and t(1 − a), with the anchor clamped to [0, 1]; where t is 0, any anchor would do and
/// `anchor` is kept.
fn with_lens_part(t: f32, lens: f32, anchor: f32) -> [f32; 2] {
    if t == 0.0 { [t, anchor] } else { [t, (1.0 - lens / t).clamp(0.0, 1.0)] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lens::{Camera, FocusOffset};

    /// κ at a few depths.
    fn kappas([t, a]: [f32; 2]) -> [f64; 4] {
        let optics = Camera { focus_distance: 3.0, ..Camera::default() }.optics();
        [0.0, 0.1, 1.0 / 3.0, 2.0].map(|z| optics.kappa(z, FocusOffset::new(t as f64, a as f64)))
    }

    fn near(a: [f64; 4], b: [f64; 4]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5 * (1.0 + b.abs()))
    }

    #[test]
    fn nothing_changes_nothing() {
        for blend in BlendMode::ALL {
            assert_eq!(blend.blend([1.2, 0.3], [0.7, 0.9], 0.0), [1.2, 0.3]);
        }
        assert_eq!(BlendMode::Add.blend([1.2, 0.3], [1.0, 0.0], 0.7), [1.2, 0.3]);
        assert_eq!(BlendMode::MultiplyDefocus.blend([1.2, 0.3], [1.0, 0.5], 0.7), [1.2, 0.3]);
        for blend in [BlendMode::Set, BlendMode::Mix] {
            assert_eq!(blend.blend([1.2, 0.3], [0.7, 0.9], 1.0), [0.7, 0.9]);
        }
    }

    #[test]
    fn mix_mixes_the_blur_at_every_depth_and_set_does_not() {
        let (below, above) = ([1.0, 0.0], [1.04, 1.0]);
        let (k0, k1) = (kappas(below), kappas(above));
        let half = [0, 1, 2, 3].map(|k| (k0[k] + k1[k]) / 2.0);
        assert!(near(kappas(BlendMode::Mix.blend(below, above, 0.5)), half));
        assert!(!near(kappas(BlendMode::Set.blend(below, above, 0.5)), half));
    }

    #[test]
    fn multiply_scales_the_blur_at_every_depth() {
        let below = [1.03, 0.4];
        for (t, w, factor) in [(0.0, 1.0, 0.0), (0.5, 1.0, 0.5), (0.0, 0.25, 0.75)] {
            let scaled = kappas(below).map(|kappa| factor * kappa);
            assert!(near(kappas(BlendMode::MultiplyDefocus.blend(below, [t, 1.0], w)), scaled));
        }
        let doubled = BlendMode::MultiplyDefocus.blend([1.03, 1.0], [2.0, 1.0], 1.0);
        assert!(near(kappas(doubled), kappas([1.03, 1.0]).map(|kappa| 2.0 * kappa)));
        let [_, anchor] = BlendMode::MultiplyDefocus.blend([1.0, 0.0], [2.0, 1.0], 1.0);
        assert_eq!(anchor, 0.0, "the lens's own blur cannot grow");
    }
}
