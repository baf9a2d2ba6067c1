//! How strongly two neighbouring places of a surface belong together.

/// What a place looks like: all that the affinity of two of them depends on. Nothing depends on a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeAppearance {
    /// Colour, encoded by sRGB's curve so that equal differences look equal; [0, 1] for what a display can show.
    pub color: [f32; 3],
    /// Unit normal; zero if there is none.
    pub normal: [f32; 3],
}

/// The law from two appearances to an affinity:
///
/// ```text
/// w = max(exp(−|Δc|²/σc² − (1 − n·n′)/σn), LEAST_AFFINITY)
/// ```
///
/// | symbol | field | meaning | range |
/// | --- | --- | --- | --- |
/// | Δc | `color` | difference of the colours | |
/// | σc | `color_scale` | difference that counts as an edge | > 0 |
/// | n·n′ | `normal` | cosine of the angle between the normals | [−1, 1] |
/// | σn | `normal_scale` | what the same is for normals | > 0 |
///
/// The first term is Grady's (2006, equation 1), the second is the same for creases. Whatever is not a number counts as
/// a full edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affinity {
    /// The difference of colour that counts as an edge, > 0.
    pub color_scale: f32,
    /// The difference 1 − n·n′ of normals that counts as an edge, > 0.
    pub normal_scale: f32,
}

/// The affinity of neighbours that nothing but their place connects: above 0, so that every connected surface can be
/// reached, and so small that an edge of 10⁴ texels conducts no more than a single link inside.
pub const LEAST_AFFINITY: f32 = 1e-4;

impl Default for Affinity {
    /// Edges from about a tenth of the range of colours, and from creases of about 45°.
    fn default() -> Self {
        Self { color_scale: 0.06, normal_scale: 0.3 }
    }
}

impl Affinity {
    /// The affinity of two neighbours, in [[`LEAST_AFFINITY`], 1].
    pub fn between(&self, a: &NodeAppearance, b: &NodeAppearance) -> f32 {
        let color = squared_distance(a.color, b.color) / (self.color_scale * self.color_scale);
        let cosine: f32 = (0..3).map(|k| a.normal[k] * b.normal[k]).sum();
        let crease = (1.0 - cosine).max(0.0) / self.normal_scale;
        let affinity = (-color - crease).exp();
        // Not `max`, which ignores a NaN on its left only by convention.
        if affinity > LEAST_AFFINITY { affinity.min(1.0) } else { LEAST_AFFINITY }
    }
}

/// |a − b|².
pub(crate) fn squared_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLAT: NodeAppearance = NodeAppearance { color: [0.5; 3], normal: [0.0, 0.0, 1.0] };

    #[test]
    fn equal_neighbours_have_affinity_one_and_edges_have_less() {
        let affinity = Affinity::default();
        assert_eq!(affinity.between(&FLAT, &FLAT), 1.0);
        let tinted = NodeAppearance { color: [0.55, 0.5, 0.5], ..FLAT };
        let turned = NodeAppearance { normal: [1.0, 0.0, 0.0], ..FLAT };
        let (tint, turn) = (affinity.between(&FLAT, &tinted), affinity.between(&FLAT, &turned));
        assert!((tint - (-(0.05f32 / 0.06).powi(2)).exp()).abs() < 1e-5);
        assert!((turn - (-1.0f32 / 0.3).exp()).abs() < 1e-5);
    }

    #[test]
    fn what_is_no_number_is_a_full_edge() {
        let affinity = Affinity::default();
        for color in [[f32::NAN; 3], [f32::INFINITY; 3], [9.0; 3]] {
            assert_eq!(affinity.between(&FLAT, &NodeAppearance { color, ..FLAT }), LEAST_AFFINITY);
        }
        let normal = [f32::NAN; 3];
        let unknown = affinity.between(&FLAT, &NodeAppearance { normal, ..FLAT });
        assert!((LEAST_AFFINITY..=1.0).contains(&unknown));
    }
}
