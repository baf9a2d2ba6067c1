//! Errors and exit codes.

use document::DocumentError;
use jobs::JobError;
use project::ProjectError;
use render::RenderError;
use session::SessionError;
use std::path::Path;

/// Wrong usage.
pub const WRONG_USAGE: u8 = 2;
/// A file or value that cannot be used, or an internal error.
pub const BAD_INPUT: u8 = 3;
/// Only part of the request was carried out.
pub const PARTLY_DONE: u8 = 4;
/// A GPU was requested and none is able to do the work.
pub const NO_GPU: u8 = 5;
/// A temporary problem of the machine.
pub const TRY_AGAIN: u8 = 75;

/// Why a command failed.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The exit code.
    pub code: u8,
    /// One line: `FILE: what is wrong (what to do)`.
    pub message: String,
    /// Whether it is an internal error of the program.
    pub is_internal: bool,
}

impl Failure {
    fn new(code: u8, message: impl Into<String>) -> Self {
        let message: String = message.into();
        Self { code, message: message.replace('\n', " "), is_internal: false }
    }

    /// Bad input.
    pub fn bad_input(message: impl Into<String>) -> Self {
        Self::new(BAD_INPUT, message)
    }

    /// Wrong usage.
    pub fn wrong_usage(message: impl Into<String>) -> Self {
        Self::new(WRONG_USAGE, message)
    }

    /// Partly done.
    pub fn partly_done(message: impl Into<String>) -> Self {
        Self::new(PARTLY_DONE, message)
    }

    /// Parts of a capture are missing: the command succeeded partly.
    pub fn incomplete_capture(file: &Path) -> Self {
        Self::partly_done(format!("{}: parts of it are missing (see the warnings above)", file.display()))
    }

    /// A temporary failure.
    pub fn try_again(message: impl Into<String>) -> Self {
        Self::new(TRY_AGAIN, message)
    }

    /// The process was asked to terminate.
    pub fn terminated() -> Self {
        Self::try_again("stopped: finished work is kept (run the command again to resume)")
    }

    /// An internal error.
    pub fn internal(message: impl Into<String>) -> Self {
        Self { is_internal: true, ..Self::new(BAD_INPUT, message) }
    }
}

impl From<SessionError> for Failure {
    fn from(error: SessionError) -> Self {
        let message = error.to_string();
        match error {
            SessionError::TryAgain(_) => Self::try_again(message),
            SessionError::GpuAbsent(_) => Self::new(NO_GPU, message),
            SessionError::Internal(_) => Self::internal(message),
            SessionError::Cancelled => Self::terminated(),
            SessionError::NothingOpen | SessionError::BadInput(_) | SessionError::NearUnknown { .. } => {
                Self::bad_input(message)
            }
        }
    }
}

impl From<DocumentError> for Failure {
    fn from(error: DocumentError) -> Self {
        SessionError::from(error).into()
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        SessionError::from(error).into()
    }
}

impl From<JobError> for Failure {
    fn from(error: JobError) -> Self {
        SessionError::from(error).into()
    }
}

impl From<ProjectError> for Failure {
    fn from(error: ProjectError) -> Self {
        SessionError::from(error).into()
    }
}
