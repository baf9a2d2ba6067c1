//! Who gets which part of a standard picture's pixel.
//!
//! Every ray of a standard camera ends on exactly one surface: the coverage of the standard picture is 1. Samples that
//! see the whole aperture cover their part of it exactly. What they leave belongs to the samples that are partly
//! occluded, whose visibility is known only cell by cell of the aperture: alone they would bleed over the outlines of what
//! occludes them, and fall short beside them. So the unpainted ones among them are summed apart, and share, pixel by pixel,
//! what the open ones leave:
//!
//! ```text
//! picture(q) = free(q) + share(q)·sharing(q),    share(q) = (1 − open(q)) / partial(q)
//! ```
//!
//! with `open` and `partial` the coverage of the *standard* picture by either kind. A ray's share does not depend on
//! paint: paint that moves other rays to or from q leaves it as it is. Painted samples are summed with the visibility of
//! their cells as it stands.

/// The factor of the partly occluded samples in a pixel whose standard coverage is `open` + `partial`.
///
/// It stays within [0, 8]: where almost nothing partial lies, what is left is the error of the open ones, and is
/// not blown up.
pub fn share_of_partial(open: f64, partial: f64) -> f32 {
    const LARGEST: f64 = 8.0;
    const LEAST_PARTIAL: f64 = 1e-3;
    if partial < LEAST_PARTIAL { 1.0 } else { ((1.0 - open) / partial).clamp(0.0, LARGEST) as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_shared() {
        assert_eq!(share_of_partial(0.25, 0.5), 1.5);
        assert_eq!(share_of_partial(1.02, 0.5), 0.0);
        assert_eq!(share_of_partial(0.0, 0.01), 8.0);
        assert_eq!(share_of_partial(0.9, 0.0), 1.0);
    }
}
