//! How far light is off, as far as refined light tells it.

/// How far pictures are from what refined light comes to in the end, the mean square of linear values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightErrors {
    /// The one whose light was refined, by the noise of paths.
    pub refined: f64,
    /// The one that stands.
    pub displayed: f64,
}

/// Noise of four times as many paths over that of as many, as mean squares: a quarter, but for single paths that carry much, of which many
/// are needed to see any; so it is taken for more.
const NEXT_NOISE_RATIO: f64 = 0.5;

impl LightErrors {
    /// By the mean squares of how far a picture of refined light is from one of a quarter of its passes, and from one that stands: errors
    /// that have nothing to do with each other add as squares.
    pub fn from_mean_squares(from_last: f64, from_displayed: f64) -> Self {
        let refined = from_last * NEXT_NOISE_RATIO / (1.0 + NEXT_NOISE_RATIO);
        Self { refined, displayed: (from_displayed - refined).max(0.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_told_from_what_is_off() {
        // Light of 4 passes has a noise of 4, of 16 one of 2; what stands is 8 off, or hardly.
        let errors = LightErrors::from_mean_squares(6.0, 10.0);
        assert!((errors.refined - 2.0).abs() < 1e-12 && (errors.displayed - 8.0).abs() < 1e-12, "{errors:?}");
        let errors = LightErrors::from_mean_squares(6.0, 2.4);
        assert!(errors.refined > errors.displayed, "{errors:?}");
        assert_eq!(LightErrors::from_mean_squares(6.0, 0.5).displayed, 0.0);
    }
}
