//! Why a picture could not be summed.

use crate::resolve::Overflow;
use progress::Cancelled;

/// Why a picture could not be summed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SplatError {
    /// The progress was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// The integer sum could overflow.
    #[error("the scene's radiance is too high to be summed exactly (keep the brightest light below 1e6)")]
    Overflow,
}

impl From<Cancelled> for SplatError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<Overflow> for SplatError {
    fn from(_: Overflow) -> Self {
        Self::Overflow
    }
}
