//! Numbers in fewer bytes.

use glam::{DVec3, Vec3};

/// A number that is not negative: the exponent of an f32 and 16 bits of its mantissa, rounded to within 2⁻¹⁷ of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Float24(pub [u8; 3]);

impl Float24 {
    /// The nearest number of 24 bits; `None` if the value is negative, not finite, or rounds to infinity.
    pub fn new(value: f32) -> Option<Self> {
        if value == 0.0 {
            return Some(Self([0; 3]));
        }
        let bits = value.to_bits();
        let [a, b, c, _] = (bits.checked_add(0x3F + (bits >> 7 & 1))? >> 7).to_le_bytes();
        let rounded = Self([a, b, c]);
        (value > 0.0 && rounded.get().is_finite()).then_some(rounded)
    }

    /// The number, as a float of 32 bits; exact.
    pub fn get(self) -> f32 {
        let [a, b, c] = self.0;
        f32::from_bits(u32::from_le_bytes([a, b, c, 0]) << 7)
    }

    /// The nearest number whose last `dropped` bits are 0; itself where that would be infinite.
    pub fn coarser(self, dropped: u32) -> Self {
        let [a, b, c] = self.0;
        let bits = u32::from_le_bytes([a, b, c, 0]);
        let [a, b, c, _] = (((bits + (1 << dropped >> 1)) >> dropped) << dropped).to_le_bytes();
        let rounded = Self([a, b, c]);
        if rounded.get().is_finite() { rounded } else { self }
    }
}

/// Red, green and blue that are not negative: 11 bits each below a common exponent of 7 from 2⁻⁶⁴ on.
///
/// Each is rounded up or down, by less than 2⁻¹⁰ of the largest, with a probability that keeps its mean: a wall of one colour
/// that is not among those that there are would else be too bright or too dark all over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rgb40(pub [u8; 5]);

impl Rgb40 {
    const MANTISSA_BITS: i32 = 11;
    /// The least exponent: what is below 2⁻⁷⁵ is taken for 0.
    const MIN_EXPONENT: i32 = -64;
    const MAX_EXPONENT: i32 = 63;

    /// `None` if one is negative or not finite, or from 2⁶⁴ on. `chance` decides, evenly spread over [0, 1), what is rounded
    /// up: red, green and blue.
    pub fn new(rgb: Vec3, chance: [f64; 3]) -> Option<Self> {
        if !(rgb.is_finite() && rgb.cmpge(Vec3::ZERO).all()) {
            return None;
        }
        let exponent = ((rgb.max_element().to_bits() >> 23) as i32 - 127).max(Self::MIN_EXPONENT);
        let mantissas = |exponent: i32| {
            let quantum = f64::from(exponent - Self::MANTISSA_BITS + 1).exp2();
            let quanta = rgb.as_dvec3() / quantum;
            (quanta + DVec3::from_array(chance)).to_array().map(|value| value as u64)
        };
        let fits = |exponent: &i32| mantissas(*exponent).iter().all(|&m| m < 1 << Self::MANTISSA_BITS);
        let exponent = (exponent..=Self::MAX_EXPONENT).find(fits)?;
        let [r, g, b] = mantissas(exponent);
        let bits = (exponent - Self::MIN_EXPONENT) as u64 | r << 7 | g << 18 | b << 29;
        let [a, b, c, d, e, ..] = bits.to_le_bytes();
        Some(Self([a, b, c, d, e]))
    }

    /// The nearest colour whose channels have `bits` bits, 1 to 11, below the common exponent.
    pub fn coarser(self, bits: u32) -> Self {
        let dropped = Self::MANTISSA_BITS as u32 - bits;
        let [a, b, c, d, e] = self.0;
        let all = u64::from_le_bytes([a, b, c, d, e, 0, 0, 0]);
        let most = (1 << bits) - 1;
        let rounded = [7, 18, 29].map(|at| {
            let mantissa = all >> at & 0x7FF;
            (((mantissa + (1 << dropped >> 1)) >> dropped).min(most) << dropped) << at
        });
        let [a, b, c, d, e, ..] = (all & 0x7F | rounded[0] | rounded[1] | rounded[2]).to_le_bytes();
        Self([a, b, c, d, e])
    }

    /// The colour, linear RGB; exact.
    pub fn get(self) -> Vec3 {
        let [a, b, c, d, e] = self.0;
        let bits = u64::from_le_bytes([a, b, c, d, e, 0, 0, 0]);
        let exponent = (bits & 0x7F) as i32 + Self::MIN_EXPONENT - Self::MANTISSA_BITS + 1;
        // All of these exponents are those of ordinary numbers.
        let quantum = f32::from_bits(((exponent + 127) as u32) << 23);
        Vec3::from_array([7, 18, 29].map(|at| (bits >> at & 0x7FF) as f32 * quantum))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarser_numbers_are_near() {
        for k in 0..20_000 {
            let value = (k as f32 * 0.37).sin().abs() * (k as f32 * 0.005 - 50.0).exp2();
            let number = Float24::new(value).unwrap();
            let apart = (number.coarser(4).get() - number.get()).abs();
            assert!(apart <= value * 2f32.powi(-13) && number.coarser(4).0[0] & 15 == 0, "{value}");
            assert_eq!(number.coarser(0), number);
            let rgb = Rgb40::new(Vec3::new(value, value * 0.3, value * 1e-3), [0.5; 3]).unwrap();
            let apart = (rgb.coarser(8).get() - rgb.get()).abs().max_element();
            assert!(apart <= rgb.get().max_element() * 2f32.powi(-8), "{value}");
            assert_eq!(rgb.coarser(11), rgb);
        }
        let largest = Float24([0xFF, 0xFF, 0xFE]);
        assert!(largest.coarser(4).get().is_finite());
    }

    #[test]
    fn numbers_come_back_as_close_as_is_said() {
        for k in 0..20_000 {
            let value = (k as f32 * 0.37).sin().abs() * (k as f32 * 0.005 - 50.0).exp2();
            let found = Float24::new(value).unwrap().get();
            assert!((found - value).abs() <= value * 2f32.powi(-17), "{value}: {found}");
            let rgb = Vec3::new(value, value * 0.3, value * 1e-3);
            let chance = [0.2, 0.9, 0.999].map(|c: f64| (c + f64::from(k) * 0.1).fract());
            let error = (Rgb40::new(rgb, chance).unwrap().get() - rgb).abs().max_element();
            assert!(error <= value * 2f32.powi(-10), "{rgb}: {error}");
        }
    }

    #[test]
    fn powers_of_two_and_zero_are_exact_and_what_does_not_fit_is_told() {
        for exponent in -60..60 {
            let value = (exponent as f32).exp2();
            assert_eq!(Float24::new(value).unwrap().get(), value);
            assert_eq!(Rgb40::new(Vec3::splat(value), [0.0, 0.5, 0.999]).unwrap().get(), Vec3::splat(value));
        }
        assert_eq!(Float24::new(-0.0).unwrap().get(), 0.0);
        assert_eq!(Rgb40::new(Vec3::ZERO, [0.9; 3]).unwrap().get(), Vec3::ZERO);
        assert_eq!(Rgb40::new(Vec3::splat(2f32.powi(-90)), [0.5; 3]).unwrap().get(), Vec3::ZERO);
        // Just below a power of two, which it rounds up to.
        let below = Vec3::new(1.0 - f32::EPSILON, 0.5, 0.0);
        assert_eq!(Rgb40::new(below, [0.9; 3]).unwrap().get(), Vec3::new(1.0, 0.5, 0.0));
        for bad in [-1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!((Float24::new(bad), Rgb40::new(Vec3::new(1.0, bad, 1.0), [0.0; 3])), (None, None));
        }
        assert_eq!((Float24::new(f32::MAX), Rgb40::new(Vec3::splat(2f32.powi(64)), [0.0; 3])), (None, None));
        assert!(Rgb40::new(Vec3::splat(1e6), [0.0; 3]).is_some());
    }

    #[test]
    fn colours_keep_their_mean() {
        let rgb = Vec3::new(0.7003, 0.2111, 1e-3);
        let chance = |k: u32| [0.0, 0.3, 0.7].map(|first: f64| (first + f64::from(k) * 0.618_034).fract());
        let all = (0..10_000).map(|k| Rgb40::new(rgb, chance(k)).unwrap().get().as_dvec3());
        let mean = all.sum::<DVec3>() / 10_000.0;
        assert!((mean - rgb.as_dvec3()).abs().max_element() < 1e-6, "{mean}");
    }
}
