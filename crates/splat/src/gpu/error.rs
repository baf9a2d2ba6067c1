//! Why work on a card ends early.

use crate::resolve::Overflow;
use graphics_card::Lost;
use progress::Cancelled;

/// Why a sum on the card failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GpuError {
    /// The card no longer works, or does not hold the picture.
    Lost,
    /// A pixel holds more than its integers do.
    Overflow,
    /// The progress was cancelled.
    Cancelled,
}

impl From<Lost> for GpuError {
    fn from(_: Lost) -> Self {
        Self::Lost
    }
}

impl From<Overflow> for GpuError {
    fn from(_: Overflow) -> Self {
        Self::Overflow
    }
}

impl From<Cancelled> for GpuError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}
