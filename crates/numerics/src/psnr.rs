//! The peak signal-to-noise ratio.

/// The PSNR of equal pictures: that of a mean square error of 1e-20.
const MAX_PSNR: f64 = 200.0;

/// The peak signal-to-noise ratio, in dB, of a mean square error for a peak of 1: −10 log₁₀, at most 200.
pub fn psnr(mean_square: f64) -> f64 {
    if mean_square < 1e-20 { MAX_PSNR } else { -10.0 * mean_square.log10() }
}

/// The mean square error of a PSNR in dB, of values in [0, 1].
pub fn mean_square_of_psnr(psnr: f64) -> f64 {
    10f64.powf(-psnr / 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tenth_is_twenty_decibels() {
        assert_eq!((psnr(1.0), psnr(0.0)), (0.0, MAX_PSNR));
        assert!((psnr(0.1f64.powi(2)) - 20.0).abs() < 1e-12);
        assert!(psnr(f64::NAN).is_nan());
    }
}
