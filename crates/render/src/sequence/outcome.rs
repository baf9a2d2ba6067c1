//! What becomes of a piece of work that is one of many: a frame, a tile.

use crate::error::RenderError;

/// What became of a frame, or of a tile.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// It was drawn and written.
    Written,
    /// It was there already, by the same plan, and whole.
    Skipped,
    /// It could not be made.
    Failed(RenderError),
}

impl Outcome {
    /// In a word, as reports have it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Written => "written",
            Self::Skipped => "skipped",
            Self::Failed(_) => "failed",
        }
    }

    /// Why it could not be made.
    pub fn error(&self) -> Option<&RenderError> {
        match self {
            Self::Failed(error) => Some(error),
            Self::Written | Self::Skipped => None,
        }
    }
}
