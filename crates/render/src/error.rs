//! Errors of baking and rendering, grouped by what the user can do about them.

use document::{DocumentError, IoFault};
use jobs::JobError;
use light::LightError;
use progress::Cancelled;
use project::ProjectError;
use scene::SceneError;
use splat::SplatError;
use std::path::Path;

/// An error of baking, rendering or exporting. It displays as one line: `FILE: what is wrong (what to do)`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// A file or a value cannot be used; the text names it, what is wrong and what to do.
    #[error("{0}")]
    BadInput(String),
    /// A temporary problem of the machine rather than the input, for example a full disk or a locked file.
    #[error("{0}")]
    TryAgain(String),
    /// A GPU was requested, but none is available that can do the work.
    #[error("{0}")]
    GpuAbsent(String),
    /// The user stopped the work, or a newer request replaced it.
    #[error("cancelled")]
    Cancelled,
    /// A bug in the program.
    #[error("{0}")]
    Internal(String),
}

impl From<Cancelled> for RenderError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<DocumentError> for RenderError {
    fn from(error: DocumentError) -> Self {
        match error {
            DocumentError::BadInput(text) | DocumentError::NearUnknown { text, .. } => Self::BadInput(text),
            DocumentError::TryAgain(text) => Self::TryAgain(text),
            DocumentError::Cancelled => Self::Cancelled,
            DocumentError::Internal(text) => Self::Internal(text),
        }
    }
}

impl From<JobError> for RenderError {
    fn from(error: JobError) -> Self {
        match error {
            JobError::NoThread { .. } => Self::TryAgain(error.to_string()),
            JobError::Panicked { .. } => Self::Internal(error.to_string()),
        }
    }
}

impl From<LightError> for RenderError {
    fn from(error: LightError) -> Self {
        DocumentError::from(error).into()
    }
}

impl From<ProjectError> for RenderError {
    fn from(error: ProjectError) -> Self {
        DocumentError::from(error).into()
    }
}

impl From<SceneError> for RenderError {
    fn from(error: SceneError) -> Self {
        DocumentError::from(error).into()
    }
}

impl From<SplatError> for RenderError {
    fn from(error: SplatError) -> Self {
        match error {
            SplatError::Cancelled => Self::Cancelled,
            other => Self::BadInput(other.to_string()),
        }
    }
}

impl From<IoFault> for RenderError {
    fn from(fault: IoFault) -> Self {
        DocumentError::from(fault).into()
    }
}

impl RenderError {
    /// A [`RenderError::BadInput`] about `file`; `what` says what is wrong and what to do.
    pub fn bad_file(file: &Path, what: impl std::fmt::Display) -> Self {
        DocumentError::bad_file(file, what).into()
    }

    /// Classifies an I/O error on `file` as bad input or as a temporary problem.
    pub fn io(file: &Path, error: &std::io::Error) -> Self {
        IoFault::new(file, error).into()
    }
}
