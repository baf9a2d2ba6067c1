//! What can go wrong when light is solved for.

use progress::Cancelled;
use slf::PhotographError;

/// Why there is no light.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LightError {
    /// Photographs cannot be used; the text names the file, what is wrong and what to do.
    #[error("{0}")]
    BadInput(String),
    /// The user stopped it, or a newer request took its place.
    #[error("cancelled")]
    Cancelled,
    /// A fault of the program itself.
    #[error("{0}")]
    Internal(String),
}

impl From<Cancelled> for LightError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<PhotographError> for LightError {
    fn from(error: PhotographError) -> Self {
        match error {
            PhotographError::Cancelled => Self::Cancelled,
            other => Self::BadInput(other.to_string()),
        }
    }
}
