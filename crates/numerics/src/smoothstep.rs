//! Smooth transitions.

use crate::real::Real;

/// The cubic 3t² − 2t³, evaluated as t·t·(3 − 2t): from 0 at t = 0 to 1 at t = 1, level at both ends.
///
/// Not clamped: beyond \[0, 1\] it turns back.
#[inline]
pub fn smooth_fraction<T: Real>(t: T) -> T {
    t * t * (T::from_f64(3.0) - T::from_f64(2.0) * t)
}

/// Rises smoothly from 0 at `from` to 1 at `to`, and is constant beyond: [`smooth_fraction`] of (value − from) / (to −
/// from), clamped to \[0, 1\].
///
/// Falls if `to` is less than `from`. Where both are equal it is a step, and NaN at that value; NaN of NaN.
#[inline]
pub fn smoothstep<T: Real>(value: T, [from, to]: [T; 2]) -> T {
    smooth_fraction(((value - from) / (to - from)).clamped_to_unit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rises_and_falls_between_its_ends() {
        for (value, expected) in [(-1.0f32, 0.0f32), (2.0, 0.0), (3.0, 0.5), (4.0, 1.0), (1e30, 1.0)] {
            assert_eq!(smoothstep(value, [2.0f32, 4.0]), expected, "{value}");
            assert_eq!(smoothstep(f64::from(value), [4.0, 2.0]), 1.0 - f64::from(expected), "{value}");
        }
        assert_eq!(smoothstep(f64::INFINITY, [2.0, 4.0]), 1.0);
    }

    #[test]
    fn is_level_at_both_ends() {
        let slope = |t: f64| (smooth_fraction(t + 1e-6) - smooth_fraction(t - 1e-6)) / 2e-6;
        assert!(slope(0.0).abs() < 1e-5 && slope(1.0).abs() < 1e-5 && (slope(0.5) - 1.5).abs() < 1e-5);
        assert_eq!([0.0, 0.25, 1.0].map(smooth_fraction::<f32>), [0.0, 0.15625, 1.0]);
    }

    #[test]
    fn without_width_it_is_a_step() {
        assert_eq!([1.0, 3.0].map(|value: f32| smoothstep(value, [2.0; 2])), [0.0, 1.0]);
        assert!(smoothstep(2.0, [2.0f32; 2]).is_nan() && smoothstep(f64::NAN, [0.0, 1.0]).is_nan());
    }
}
