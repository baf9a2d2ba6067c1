//! Errors of this crate.

/// The most labels that are spread at once.
pub const MAX_LABELS: usize = 16;

/// Why labels cannot be spread.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SpreadError {
    /// The work was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// There is nothing to spread.
    #[error("nothing is painted that could be spread (paint a stroke on the layer first)")]
    NoSeeds,
    /// More labels than can be told apart.
    #[error(
        "{count} different values are painted, at most {MAX_LABELS} can be spread (paint with fewer values)"
    )]
    TooManyLabels {
        /// How many there are.
        count: usize,
    },
}

impl From<progress::Cancelled> for SpreadError {
    fn from(_: progress::Cancelled) -> Self {
        Self::Cancelled
    }
}
