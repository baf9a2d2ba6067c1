//! What is painted: the focus offset t, its anchor a, and whether gloss obeys them.

/// How one surface point is focused.
///
/// | t, anchor | model |
/// | --- | --- |
/// | 1, 0 | the standard thin lens, the unpainted default |
/// | t, 0 | offset relative to the sensor: the ray travels t·d |
/// | t, 1 | offset relative to the point's own focal conjugate: the same blur wherever the camera focuses |
///
/// That is the light that the point sends of its own: emitted, scattered diffusely. What it mirrors or lets through comes from
/// elsewhere and keeps the ordinary lens's focus, but for the share `gloss` ([`Self::of_carried`]).
///
/// Any finite t is allowed (negative too: the ray is then followed backwards, which only blurs more). Readers
/// refuse what is not valid; where it gets into a field all the same it counts as [`Self::STANDARD`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FocusOffset {
    /// The focus offset t, the transmission distance as a share of the anchor's distance; 1 is no offset.
    pub t: f64,
    /// What t is relative to, in [0, 1]: 0 the sensor, 1 the point's focal conjugate.
    pub anchor: f64,
    /// How far the light that the point carries (mirrors, transmits) also obeys t and anchor, in [0, 1]: 0 not at
    /// all, 1 like its own light.
    pub gloss: f64,
}

impl FocusOffset {
    /// The unpainted default: the ordinary thin lens.
    pub const STANDARD: Self = Self::new(1.0, 0.0);
    /// In focus, wherever the camera focuses.
    pub const SHARP: Self = Self::new(1.0, 1.0);

    /// A focus offset of `t` relative to `anchor` (0 the sensor, 1 the point's conjugate), with gloss 0: carried
    /// light keeps the lens's focus.
    pub const fn new(t: f64, anchor: f64) -> Self {
        Self { t, anchor, gloss: 0.0 }
    }

    /// The same focus with this gloss, in [0, 1].
    pub const fn with_gloss(self, gloss: f64) -> Self {
        Self { gloss, ..self }
    }

    /// How the light that the point carries is focused: t and anchor that far from the ordinary lens's to the painted,
    ///
    /// ```text
    /// t' = 1 + gloss·(t − 1)        a' = gloss·a
    /// ```
    ///
    /// so that κ moves from the standard one to that of the point's own light: in proportion where a = 0 or t = 1, else but for
    /// gloss·(1 − gloss)·(t − 1)·a·(1/s − 1/z), little of the blur that a t gives. At 0 and at 1 it is exactly the one and the
    /// other. Always valid, since t' and a' lie between those of the two.
    #[inline]
    pub fn of_carried(self) -> Self {
        let Self { t, anchor, gloss } = self.or_standard();
        if gloss >= 1.0 { Self::new(t, anchor) } else { Self::new(1.0 + gloss * (t - 1.0), gloss * anchor) }
    }

    /// Whether the point, and so all of its light, is focused by the ordinary thin lens.
    pub fn is_standard(self) -> bool {
        (self.t, self.anchor) == (Self::STANDARD.t, Self::STANDARD.anchor)
    }

    /// Itself if valid, else the standard lens: the value that every renderer uses.
    #[inline]
    pub fn or_standard(self) -> Self {
        if self.is_valid() { self } else { Self::STANDARD }
    }

    /// Whether all numbers are usable: t finite, anchor and gloss in [0, 1].
    #[inline]
    pub fn is_valid(self) -> bool {
        let unit = 0.0..=1.0;
        self.t.is_finite() && unit.contains(&self.anchor) && unit.contains(&self.gloss)
    }
}

impl Default for FocusOffset {
    fn default() -> Self {
        Self::STANDARD
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_valid_counts_as_standard() {
        let painted = FocusOffset::new(-3.0, 0.5);
        assert_eq!(painted.or_standard(), painted);
        for (t, anchor) in [(f64::NAN, 0.0), (f64::INFINITY, 1.0), (1.1, f64::NAN), (1.1, -0.1), (1.1, 1.1)] {
            assert_eq!(FocusOffset::new(t, anchor).or_standard(), FocusOffset::STANDARD, "{t} {anchor}");
        }
        for gloss in [f64::NAN, -0.1, 1.1] {
            assert_eq!(painted.with_gloss(gloss).or_standard(), FocusOffset::STANDARD, "{gloss}");
            assert_eq!(painted.with_gloss(gloss).of_carried(), FocusOffset::STANDARD, "{gloss}");
        }
    }

    #[test]
    fn carried_light_goes_from_the_lens_to_the_paint() {
        for (t, anchor) in [(0.1, 0.3), (1.0, 1.0), (1.1, 0.7), (-3.0, 1.0), (1e6, 0.0)] {
            let painted = FocusOffset::new(t, anchor);
            assert_eq!(painted.of_carried(), FocusOffset::STANDARD, "{t} {anchor}");
            assert_eq!(painted.with_gloss(1.0).of_carried(), painted, "{t} {anchor}");
            let half = painted.with_gloss(0.5).of_carried();
            assert_eq!((half.t, half.anchor), ((1.0 + t) / 2.0, anchor / 2.0));
        }
        let unpainted = FocusOffset::STANDARD.with_gloss(0.3);
        assert!(unpainted.is_standard() && unpainted.of_carried() == FocusOffset::STANDARD);
    }
}
