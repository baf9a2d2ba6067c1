//! Errors of documents, by what the user can do about them.

use light::LightError;
use progress::Cancelled;
use std::io::Error;
use std::path::{Path, PathBuf};

/// Why something could not be opened, saved or edited. The text is one line: `FILE: what is wrong (what to do)`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DocumentError {
    /// A file or a value cannot be used. The text says which, what is wrong and what to do.
    #[error("{0}")]
    BadInput(String),
    /// A capture's depth map does not say which end is near. The text says how to specify it.
    #[error("{text}")]
    NearUnknown {
        /// The depth map.
        map: PathBuf,
        /// The message.
        text: String,
    },
    /// The machine, not the input, prevents it for now: a full disk, a locked file.
    #[error("{0}")]
    TryAgain(String),
    /// The user cancelled it, or a newer request replaced it.
    #[error("cancelled")]
    Cancelled,
    /// A fault of the program itself.
    #[error("{0}")]
    Internal(String),
}

impl From<Cancelled> for DocumentError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<LightError> for DocumentError {
    fn from(error: LightError) -> Self {
        match error {
            LightError::BadInput(text) => Self::BadInput(text),
            LightError::Cancelled => Self::Cancelled,
            LightError::Internal(text) => Self::Internal(text),
        }
    }
}

impl From<IoFault> for DocumentError {
    fn from(fault: IoFault) -> Self {
        if fault.is_temporary { Self::TryAgain(fault.text) } else { Self::BadInput(fault.text) }
    }
}

impl DocumentError {
    /// [`Self::BadInput`] that says what is wrong with `file`.
    pub fn bad_file(file: &Path, message: impl std::fmt::Display) -> Self {
        Self::BadInput(format!("{}: {message}", file.display()))
    }

    /// The error for an I/O error on `file`: [`Self::TryAgain`] if it is temporary, otherwise [`Self::BadInput`].
    pub fn io(file: &Path, error: &Error) -> Self {
        IoFault::new(file, error).into()
    }
}

/// What an I/O error on a file means to the user.
#[derive(Clone, Debug, PartialEq)]
pub struct IoFault {
    /// One line: `FILE: what is wrong (what to do)`.
    pub text: String,
    /// Whether the machine, not the input, prevents it for now.
    pub is_temporary: bool,
}

impl IoFault {
    /// The fault for `error` on `file`.
    pub fn new(file: &Path, error: &Error) -> Self {
        use std::io::ErrorKind::{
            Deadlock, Interrupted, NotFound, OutOfMemory, PermissionDenied, QuotaExceeded, ResourceBusy,
            StorageFull, TimedOut, WouldBlock,
        };
        let (remedy, is_temporary) = match error.kind() {
            StorageFull | QuotaExceeded => ("free some disk space and try again", true),
            ResourceBusy | Deadlock | TimedOut | WouldBlock | Interrupted | OutOfMemory => {
                ("try again", true)
            }
            NotFound => ("check the path", false),
            PermissionDenied => ("check the permissions", false),
            _ => ("check the path and the disk", false),
        };
        Self { text: format!("{}: {} ({remedy})", file.display(), without_error_number(error)), is_temporary }
    }
}

/// The operating system's message without its error number.
fn without_error_number(error: &Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}

/// The last part of a path, as a document's name for people.
pub fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| PathBuf::from(path).display().to_string(), |n| n.to_string_lossy().into())
}
