//! What can go wrong in a session, by what the user can do about it.

use progress::Cancelled;
use std::path::{Path, PathBuf};

/// Why something was not done. Its text is one line: `FILE: what is wrong (what to do)`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SessionError {
    /// A command that needs a document came before one was open.
    #[error("nothing is open (open a scene or a project first)")]
    NothingOpen,
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
    /// A GPU was asked for and there is none that can do the work.
    #[error("{0}")]
    GpuAbsent(String),
    /// The user stopped it, or a newer request took its place.
    #[error("cancelled")]
    Cancelled,
    /// A fault of the program itself.
    #[error("{0}")]
    Internal(String),
}

impl From<Cancelled> for SessionError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl SessionError {
    /// Bad input in `file`.
    pub fn bad_file(file: &Path, what: impl std::fmt::Display) -> Self {
        Self::BadInput(format!("{}: {what}", file.display()))
    }

    /// What an I/O error on `file` means: bad input, or worth another try.
    pub fn io(file: &Path, error: &std::io::Error) -> Self {
        use std::io::ErrorKind::{
            Deadlock, Interrupted, OutOfMemory, QuotaExceeded, ResourceBusy, StorageFull, TimedOut,
            WouldBlock,
        };
        let text = |remedy| format!("{}: {} ({remedy})", file.display(), without_error_number(error));
        match error.kind() {
            StorageFull | QuotaExceeded => Self::TryAgain(text("free some disk space and try again")),
            ResourceBusy | Deadlock | TimedOut | WouldBlock | Interrupted | OutOfMemory => {
                Self::TryAgain(text("try again"))
            }
            std::io::ErrorKind::NotFound => Self::BadInput(text("check the path")),
            std::io::ErrorKind::PermissionDenied => Self::BadInput(text("check the permissions")),
            _ => Self::BadInput(text("check the path and the disk")),
        }
    }

    /// What a panic means to the user.
    pub(crate) fn from_panic(task: &str, payload: &(dyn std::any::Any + Send)) -> Self {
        let message = payload.downcast_ref::<&str>().copied();
        let message = message.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
        let message = message.unwrap_or("no message").lines().next().unwrap_or_default();
        Self::Internal(format!("{task}: stopped by a fault of the program: {message} (please report this)"))
    }
}

/// The operating system's sentence without its error number.
fn without_error_number(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}

/// The file of a document as people call it.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| PathBuf::from(path).display().to_string(), |n| n.to_string_lossy().into())
}
