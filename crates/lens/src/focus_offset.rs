//! What is painted: the focus offset t and its anchor a.

/// How one surface point is focused.
///
/// | t, anchor | model |
/// | --- | --- |
/// | 1, 0 | the standard thin lens, the unpainted default |
/// | t, 0 | offset relative to the sensor: the ray travels t·d |
/// | t, 1 | offset relative to the point's own focal conjugate: the same blur wherever the camera focuses |
///
/// Any finite t is allowed (negative too: the ray is then followed backwards, which only blurs more). Readers
/// refuse what is not valid; where it gets into a field all the same it counts as [`Self::STANDARD`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FocusOffset {
    /// The focus offset t, the transmission distance as a share of the anchor's distance; 1 is no offset.
    pub t: f64,
    /// What t is relative to, in [0, 1]: 0 the sensor, 1 the point's focal conjugate.
    pub anchor: f64,
}

impl FocusOffset {
    /// The unpainted default: the ordinary thin lens.
    pub const STANDARD: Self = Self { t: 1.0, anchor: 0.0 };
    /// In focus, wherever the camera focuses.
    pub const SHARP: Self = Self { t: 1.0, anchor: 1.0 };

    /// An offset of `t`, relative to `anchor`.
    pub const fn new(t: f64, anchor: f64) -> Self {
        Self { t, anchor }
    }

    /// Whether the point is focused by the ordinary thin lens.
    pub fn is_standard(self) -> bool {
        self == Self::STANDARD
    }

    /// Itself where it is valid, else the standard lens: what every renderer takes it for.
    #[inline]
    pub fn or_standard(self) -> Self {
        if self.is_valid() { self } else { Self::STANDARD }
    }

    /// Whether both numbers are usable: t finite and anchor in [0, 1].
    #[inline]
    pub fn is_valid(self) -> bool {
        self.t.is_finite() && (0.0..=1.0).contains(&self.anchor)
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
    }
}
