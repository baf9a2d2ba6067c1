//! Luminance of linear light.

use crate::real::Real;

/// The weights of linear red, green and blue in luminance, for the primaries and white of Rec. 709 (and sRGB): ITU-R
/// BT.709-6, item 3.2. They add up to 1.
pub const REC709_LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// The luminance of linear Rec. 709 light, 0.2126 R + 0.7152 G + 0.0722 B, in its unit.
///
/// Summed from red to blue in the type of the channels. Any values are allowed: negative and infinite ones as they
/// add up; NaN if a channel is.
#[inline]
pub fn luminance<T: Real>([red, green, blue]: [T; 3]) -> T {
    let [of_red, of_green, of_blue] = REC709_LUMINANCE.map(T::from_f64);
    of_red * red + of_green * green + of_blue * blue
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_add_up_to_one() {
        assert!((REC709_LUMINANCE.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        assert_eq!(REC709_LUMINANCE.map(f32::from_f64), [0.2126f32, 0.7152, 0.0722]);
        assert!((luminance([1.0f32; 3]) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn channels_are_summed_in_order() {
        for rgb in [[0.1f32, 0.7, 0.3], [1e30, -1e30, 4.0], [3e-39, 1e-45, 0.5], [-0.0; 3]] {
            let [r, g, b] = rgb;
            let expected = 0.2126f32 * r + 0.7152f32 * g + 0.0722f32 * b;
            assert_eq!(luminance(rgb).to_bits(), expected.to_bits(), "{rgb:?}");
        }
        assert_eq!(luminance([f64::INFINITY, 0.0, 0.0]), f64::INFINITY);
        assert!(luminance([0.0, f64::NAN, 0.0]).is_nan());
    }
}
