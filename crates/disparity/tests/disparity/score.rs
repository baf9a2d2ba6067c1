//! Errors of disparities, as the 4D Light Field Benchmark measures them (Honauer et al., ACCV 2016).

/// The figures of a map.
#[derive(Clone, Copy, Debug)]
pub struct Score {
    /// Percent of the pixels off by more than 0.07.
    pub bad_007: f32,
    /// Percent off by more than 0.03.
    pub bad_003: f32,
    /// Percent off by more than 0.3: another surface.
    pub bad_03: f32,
    /// A hundred times the mean squared error; NaN if any disparity is.
    pub mse_100: f32,
}

impl std::fmt::Display for Score {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { bad_007, bad_003, bad_03, mse_100 } = self;
        write!(
            f,
            "BadPix 0.07 {bad_007:.2} %, 0.03 {bad_003:.2} %, 0.3 {bad_03:.2} %, MSE × 100 {mse_100:.3}"
        )
    }
}

/// The score of the pixels that are `counted`.
pub fn score_where(estimate: &[f32], truth: &[f32], counted: impl Fn(usize) -> bool) -> Score {
    let errors: Vec<f32> =
        (0..estimate.len()).filter(|i| counted(*i)).map(|i| (estimate[i] - truth[i]).abs()).collect();
    let count = errors.len() as f32;
    let bad = |limit: f32| 100.0 * errors.iter().filter(|e| **e > limit).count() as f32 / count;
    Score {
        bad_007: bad(0.07),
        bad_003: bad(0.03),
        bad_03: bad(0.3),
        mse_100: 100.0 * errors.iter().map(|e| e * e).sum::<f32>() / count,
    }
}

/// The score of all pixels.
pub fn score(estimate: &[f32], truth: &[f32]) -> Score {
    score_where(estimate, truth, |_| true)
}
