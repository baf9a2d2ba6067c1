//! Errors of making light from photographs.

use progress::Cancelled;
use scene::PictureError;

/// Why light could not be made from photographs.
#[derive(Debug, thiserror::Error)]
pub enum PhotographError {
    /// A photograph or its mask could not be read.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// There are no photographs.
    #[error("there are no photographs (give a capture with at least one)")]
    None,
    /// There are more photographs than can be numbered.
    #[error("there are {count} photographs, at most {} can be used (leave some out)", u16::MAX)]
    TooMany {
        /// Number of photographs.
        count: usize,
    },
    /// The work was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for PhotographError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}
