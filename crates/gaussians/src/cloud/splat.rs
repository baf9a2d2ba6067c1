//! One splat.

use glam::{Quat, Vec3};

/// A splat without the coefficients of its colour beyond degree 0: a Gaussian of covariance R diag(s²) Rᵀ about its mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// The mean, in the axes of the file.
    pub mean: Vec3,
    /// R; of any length but 0 when given to a [`super::CloudBuilder`], a unit quaternion in a cloud.
    pub rotation: Quat,
    /// ln s, s the standard deviation along each axis of R; −∞ along the normal of a flat splat.
    pub log_scale: Vec3,
    /// The greatest share of light that it stops, in [0, 1].
    pub opacity: f32,
    /// The coefficient of degree 0, red, green and blue: ½ + 0.2820948 · `base_color` is the mean colour over all directions.
    pub base_color: Vec3,
}

impl Splat {
    /// How far from the mean its response may be 1/255 or more, in the units of the file.
    pub fn reach(&self) -> f64 {
        let deviations = (2.0 * (f64::from(self.opacity) * 255.0).max(1.0).ln()).sqrt();
        f64::from(self.log_scale.max_element()).exp() * deviations
    }

    /// The opacity that a file stores as a logit: 1 / (1 + e^−x).
    pub fn opacity_of_logit(logit: f64) -> f32 {
        (1.0 / (1.0 + (-logit).exp())) as f32
    }

    /// The logit of an opacity; finite, that of the nearest float of 32 bits at 0 and 1. Inverse of [`Self::opacity_of_logit`].
    pub fn logit_of_opacity(opacity: f32) -> f32 {
        let opacity =
            f64::from(opacity).clamp(f64::from(f32::MIN_POSITIVE), 1.0 - f64::from(f32::EPSILON) / 2.0);
        (opacity / (1.0 - opacity)).ln() as f32
    }

    /// The coefficient of degree 0 of a channel whose mean over all directions is `value`.
    pub fn base_of_color(value: f32) -> f32 {
        (value - 0.5) / super::harmonics::BASE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opacities_invert() {
        for opacity in [1e-6, 0.004, 0.3, 0.5, 0.99, 0.9999] {
            let back = Splat::opacity_of_logit(f64::from(Splat::logit_of_opacity(opacity)));
            assert!((back / opacity - 1.0).abs() < 1e-5, "{opacity} {back}");
        }
        assert_eq!(Splat::opacity_of_logit(f64::NEG_INFINITY), 0.0);
        assert_eq!(Splat::opacity_of_logit(f64::INFINITY), 1.0);
        assert!(Splat::logit_of_opacity(0.0).is_finite() && Splat::logit_of_opacity(1.0).is_finite());
    }
}
