//! Errors of a session, grouped by what the user can do about them.

use document::{DocumentError, IoFault};
use jobs::JobError;
use light::LightError;
use progress::Cancelled;
use project::ProjectError;
use render::RenderError;
use splat::SplatError;
use std::path::{Path, PathBuf};

/// An error of a session. It displays as one line: `FILE: what is wrong (what to do)`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SessionError {
    /// A command that needs a document was given while none is open.
    #[error("nothing is open (open a scene or a project first)")]
    NothingOpen,
    /// A file or a value cannot be used; the text names it, what is wrong and what to do.
    #[error("{0}")]
    BadInput(String),
    /// A capture's depth map does not say which end is near; the text explains how to specify it.
    #[error("{text}")]
    NearUnknown {
        /// The depth map.
        map: PathBuf,
        /// What is wrong and what to do.
        text: String,
    },
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

impl From<Cancelled> for SessionError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<JobError> for SessionError {
    fn from(error: JobError) -> Self {
        match error {
            JobError::NoThread { .. } => Self::TryAgain(error.to_string()),
            JobError::Panicked { .. } => Self::Internal(error.to_string()),
        }
    }
}

impl From<DocumentError> for SessionError {
    fn from(error: DocumentError) -> Self {
        match error {
            DocumentError::BadInput(text) => Self::BadInput(text),
            DocumentError::NearUnknown { map, text } => Self::NearUnknown { map, text },
            DocumentError::TryAgain(text) => Self::TryAgain(text),
            DocumentError::Cancelled => Self::Cancelled,
            DocumentError::Internal(text) => Self::Internal(text),
        }
    }
}

impl From<RenderError> for SessionError {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::BadInput(text) => Self::BadInput(text),
            RenderError::TryAgain(text) => Self::TryAgain(text),
            RenderError::GpuAbsent(text) => Self::GpuAbsent(text),
            RenderError::Cancelled => Self::Cancelled,
            RenderError::Internal(text) => Self::Internal(text),
        }
    }
}

impl From<LightError> for SessionError {
    fn from(error: LightError) -> Self {
        DocumentError::from(error).into()
    }
}

impl From<ProjectError> for SessionError {
    fn from(error: ProjectError) -> Self {
        DocumentError::from(error).into()
    }
}

impl From<SplatError> for SessionError {
    fn from(error: SplatError) -> Self {
        RenderError::from(error).into()
    }
}

impl From<IoFault> for SessionError {
    fn from(fault: IoFault) -> Self {
        DocumentError::from(fault).into()
    }
}

impl From<SessionError> for RenderError {
    fn from(error: SessionError) -> Self {
        let text = error.to_string();
        match error {
            SessionError::TryAgain(_) => Self::TryAgain(text),
            SessionError::GpuAbsent(_) => Self::GpuAbsent(text),
            SessionError::Cancelled => Self::Cancelled,
            SessionError::Internal(_) => Self::Internal(text),
            SessionError::NothingOpen | SessionError::BadInput(_) | SessionError::NearUnknown { .. } => {
                Self::BadInput(text)
            }
        }
    }
}

impl SessionError {
    /// A [`SessionError::BadInput`] about `file`; `what` says what is wrong and what to do.
    pub fn bad_file(file: &Path, what: impl std::fmt::Display) -> Self {
        DocumentError::bad_file(file, what).into()
    }

    /// Classifies an I/O error on `file` as bad input or as a temporary problem.
    pub fn io(file: &Path, error: &std::io::Error) -> Self {
        IoFault::new(file, error).into()
    }
}
