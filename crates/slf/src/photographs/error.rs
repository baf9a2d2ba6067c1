//! Why there is no light from photographs.

use progress::Cancelled;
use scene::PictureError;

/// Why there is no light from photographs.
#[derive(Debug, thiserror::Error)]
pub enum PhotographError {
    /// A photograph or its mask cannot be had.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// There are none.
    #[error("there are no photographs (give a capture with at least one)")]
    None,
    /// More than can be told apart.
    #[error("there are {count} photographs, at most {} can be used (leave some out)", u16::MAX)]
    TooMany {
        /// How many.
        count: usize,
    },
    /// It was stopped.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for PhotographError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}
