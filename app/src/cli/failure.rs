//! Errors and exit codes.

use project::ProjectError;
use session::SessionError;
use std::path::Path;

/// Wrong usage.
pub const WRONG_USAGE: u8 = 2;
/// A file or value that cannot be used, or a fault of the program.
pub const BAD_INPUT: u8 = 3;
/// Some of what was asked for was done.
pub const PARTLY_DONE: u8 = 4;
/// A GPU was asked for and there is none that can do the work.
pub const NO_GPU: u8 = 5;
/// The machine stands in the way for now.
pub const TRY_AGAIN: u8 = 75;

/// Why a command failed.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The exit code.
    pub code: u8,
    /// One line: `FILE: what is wrong (what to do)`.
    pub message: String,
    /// Whether it is a fault of the program itself.
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

    /// Something that a capture speaks of is missing: no failure, and nothing to pass over.
    pub fn incomplete_capture(file: &Path) -> Self {
        Self::partly_done(format!("{}: something of it is missing, see above", file.display()))
    }

    /// Worth another try.
    pub fn try_again(message: impl Into<String>) -> Self {
        Self::new(TRY_AGAIN, message)
    }

    /// A signal came to end.
    pub fn terminated() -> Self {
        Self::try_again("stopped: what is finished stays (run it again to go on)")
    }

    /// A fault of the program.
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

impl From<ProjectError> for Failure {
    fn from(error: ProjectError) -> Self {
        SessionError::from(error).into()
    }
}
