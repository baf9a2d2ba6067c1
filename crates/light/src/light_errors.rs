//! Estimated errors of light, by comparison with refined light.

/// Estimated errors of two pictures against the limit of refined light: mean squares of linear values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightErrors {
    /// The error of the picture of refined light: the noise of its paths.
    pub refined: f64,
    /// The error of the picture that is displayed.
    pub displayed: f64,
}

/// Mean squared noise after four times as many paths, relative to that before. In theory it is a quarter; rare paths that carry much light,
/// which few paths may miss altogether, make it larger.
const NEXT_NOISE_RATIO: f64 = 0.5;

impl LightErrors {
    /// Estimates the errors from two mean squared differences of the picture of refined light: `from_last`, from the picture after a quarter
    /// of its passes, and `from_displayed`, from the picture displayed. Squares of independent errors add.
    pub fn from_mean_squares(from_last: f64, from_displayed: f64) -> Self {
        let refined = from_last * NEXT_NOISE_RATIO / (1.0 + NEXT_NOISE_RATIO);
        Self { refined, displayed: (from_displayed - refined).max(0.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_separated_from_the_displayed_error() {
        // Light of 4 passes has a noise of 4, of 16 passes one of 2; the displayed picture is off by 8, or hardly.
        let errors = LightErrors::from_mean_squares(6.0, 10.0);
        assert!((errors.refined - 2.0).abs() < 1e-12 && (errors.displayed - 8.0).abs() < 1e-12, "{errors:?}");
        let errors = LightErrors::from_mean_squares(6.0, 2.4);
        assert!(errors.refined > errors.displayed, "{errors:?}");
        assert_eq!(LightErrors::from_mean_squares(6.0, 0.5).displayed, 0.0);
    }
}
