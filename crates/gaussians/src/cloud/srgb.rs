//! The transfer curve of sRGB (IEC 61966-2-1), continued above 1.

/// The linear value of an encoded one of 0 or more.
#[inline]
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The encoded value of a linear one of 0 or more. Inverse of [`srgb_to_linear`].
#[inline]
pub fn linear_to_srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_inverts() {
        for encoded in [0.0, 0.01, 0.04, 0.0405, 0.5, 1.0, 1.7, 20.0] {
            assert!(
                (linear_to_srgb(srgb_to_linear(encoded)) / encoded.max(1e-9) - 1.0).abs() < 1e-5
                    || encoded == 0.0
            );
        }
        assert!((srgb_to_linear(0.5) - 0.214_041_14).abs() < 1e-6);
        assert_eq!(srgb_to_linear(1.0), 1.0);
    }
}
