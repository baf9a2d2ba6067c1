//! Errors of solving for light.

use progress::Cancelled;
use slf::PhotographError;

/// Why light could not be solved for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LightError {
    /// Photographs cannot be used. The text says which file, what is wrong and what to do.
    #[error("{0}")]
    BadInput(String),
    /// The user cancelled it, or a newer request replaced it.
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
