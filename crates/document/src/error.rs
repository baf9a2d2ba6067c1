//! What can go wrong with a document, by what the user can do about it.

use light::LightError;
use progress::Cancelled;
use std::io::Error;
use std::path::{Path, PathBuf};

/// Why something was not opened, saved or edited. Its text is one line: `FILE: what is wrong (what to do)`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DocumentError {
    /// A file or a value cannot be used; the text names it, what is wrong and what to do.
    #[error("{0}")]
    BadInput(String),
    /// A capture's depth map does not say which end is near; the text says how to tell.
    #[error("{text}")]
    NearUnknown {
        /// The map.
        map: PathBuf,
        /// What is wrong and what to do.
        text: String,
    },
    /// The machine, not the input, stands in the way for now: a full disk, a locked file.
    #[error("{0}")]
    TryAgain(String),
    /// The user stopped it, or a newer request took its place.
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
    /// Bad input in `file`.
    pub fn bad_file(file: &Path, what: impl std::fmt::Display) -> Self {
        Self::BadInput(format!("{}: {what}", file.display()))
    }

    /// What an I/O error on `file` means: bad input, or worth another try.
    pub fn io(file: &Path, error: &Error) -> Self {
        IoFault::new(file, error).into()
    }
}

/// What an I/O error on a file means to the user.
#[derive(Clone, Debug, PartialEq)]
pub struct IoFault {
    /// One line: `FILE: what is wrong (what to do)`.
    pub text: String,
    /// Whether the machine stands in the way for now, not the input.
    pub is_temporary: bool,
}

impl IoFault {
    /// What `error` on `file` means.
    pub fn new(file: &Path, error: &Error) -> Self {
        use std::io::ErrorKind::{
            Deadlock, Interrupted, NotFound, OutOfMemory, PermissionDenied, QuotaExceeded, ResourceBusy,
            StorageFull, TimedOut, WouldBlock,
        };
        let (cure, is_temporary) = match error.kind() {
            StorageFull | QuotaExceeded => ("free some disk space and try again", true),
            ResourceBusy | Deadlock | TimedOut | WouldBlock | Interrupted | OutOfMemory => {
                ("try again", true)
            }
            NotFound => ("check the path", false),
            PermissionDenied => ("check the permissions", false),
            _ => ("check the path and the disk", false),
        };
        Self { text: format!("{}: {} ({cure})", file.display(), without_number(error)), is_temporary }
    }
}

/// The operating system's sentence without its error number.
fn without_number(error: &Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}

/// The file of a document as people call it.
pub fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| PathBuf::from(path).display().to_string(), |n| n.to_string_lossy().into())
}
