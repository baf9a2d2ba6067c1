//! Unsaved work, kept for after a crash.

use std::path::PathBuf;
use std::time::Instant;

/// Unsaved work, kept for after a crash.
#[derive(Default)]
pub(super) struct Recovery {
    /// The file that holds it, if there is one.
    pub file: Option<PathBuf>,
    /// The revision that the file, or the saved project, holds.
    pub saved_revision: u64,
    /// When the first change after that was seen.
    pub first_change: Option<Instant>,
}
