//! The outcome of one frame or tile.

use crate::error::RenderError;

/// The outcome of a frame or tile.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// It was rendered and written.
    Written,
    /// It already existed, complete and made by the same plan.
    Skipped,
    /// It could not be rendered or written.
    Failed(RenderError),
}

impl Outcome {
    /// The outcome in one word, as used in reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Written => "written",
            Self::Skipped => "skipped",
            Self::Failed(_) => "failed",
        }
    }

    /// The error of a failed frame or tile; `None` if it did not fail.
    pub fn error(&self) -> Option<&RenderError> {
        match self {
            Self::Failed(error) => Some(error),
            Self::Written | Self::Skipped => None,
        }
    }
}
