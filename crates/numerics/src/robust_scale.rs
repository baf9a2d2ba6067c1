//! The scale of residuals of which some are outliers.
//!
//! For a normal distribution the median absolute deviation (MAD) is Φ⁻¹(3/4) ≈ 0.6745 standard deviations (Hampel,
//! *The Influence Curve and Its Role in Robust Estimation*, 1974). Callers either multiply by [`MAD_SCALE`] or divide
//! by [`MAD_OF_NORMAL`]; the two roundings differ in the fifth digit, and results are kept to the bit, so that there
//! are both.

use crate::order_statistics::upper_median;
use crate::real::Real;

/// Standard deviations per median absolute deviation of a normal distribution, 1/Φ⁻¹(3/4), rounded to five digits.
pub const MAD_SCALE: f64 = 1.4826;

/// The median absolute deviation of a normal distribution in standard deviations, Φ⁻¹(3/4), rounded to four digits.
pub const MAD_OF_NORMAL: f64 = 0.6745;

/// A robust standard deviation: [`MAD_SCALE`] · the [`upper_median`] of absolute deviations, in their unit; `None` of
/// none.
///
/// Up to half of the deviations may be arbitrarily large. Equal values give 0, which callers bound from below before
/// they divide by it. The deviations are not checked for signs; they end up in another order.
pub fn scaled_mad<T: Real>(absolute_deviations: &mut [T]) -> Option<T> {
    upper_median(absolute_deviations).map(|median| T::from_f64(MAD_SCALE) * median)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_constants_are_those_of_a_normal_distribution() {
        let exact = 0.674_489_750_196_081_7;
        assert!((MAD_OF_NORMAL - exact).abs() < 5e-5 && (MAD_SCALE - 1.0 / exact).abs() < 5e-5);
        assert_eq!(f32::from_f64(MAD_OF_NORMAL), 0.6745f32);
        assert_eq!(f32::from_f64(MAD_SCALE), 1.4826f32);
    }

    #[test]
    fn normal_deviations_have_their_standard_deviation() {
        // Quantiles of the logistic distribution: its MAD is s · ln 3.
        let deviation = |k: i32| {
            let p = (f64::from(k) + 0.5) / 1000.0;
            (p / (1.0 - p)).ln().abs()
        };
        let mut deviations: Vec<f64> = (0..1000).map(deviation).collect();
        assert!((scaled_mad(&mut deviations).unwrap() - MAD_SCALE * 3f64.ln()).abs() < 0.01);
    }

    #[test]
    fn nearly_half_may_be_outliers() {
        let mut deviations = [0.1, 0.1, 0.1, 1e300, f64::INFINITY];
        assert_eq!(scaled_mad(&mut deviations), Some(MAD_SCALE * 0.1));
        assert_eq!(scaled_mad(&mut [f64::NAN, 2.0, 2.0]), Some(MAD_SCALE * 2.0));
        assert_eq!(scaled_mad(&mut [0.0f32; 3]), Some(0.0));
        assert_eq!(scaled_mad::<f64>(&mut []), None);
    }
}
