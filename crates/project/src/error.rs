//! Errors about files. Every message has the form `FILE: what is wrong (what to do)`.

use focus::FocusError;
use std::path::{Path, PathBuf};

/// Why a file could not be read, written or used.
#[derive(Debug, thiserror::Error)]
pub enum ProjectError {
    /// The file system refused to read.
    #[error("{}: cannot be read: {source} ({})", file.display(), io_cure(source))]
    Read {
        /// The file.
        file: PathBuf,
        /// The error of the file system.
        source: std::io::Error,
    },
    /// The file system refused to write. The previous content is still there.
    #[error("{}: cannot be written: {source} ({})", file.display(), io_cure(source))]
    Write {
        /// The file.
        file: PathBuf,
        /// The error of the file system.
        source: std::io::Error,
    },
    /// The file's content is invalid.
    #[error("{}: {} ({cure})", file.display(), on_one_line(problem))]
    Content {
        /// The file.
        file: PathBuf,
        /// What is wrong, and where in the file.
        problem: String,
        /// What to do.
        cure: String,
    },
    /// A field of a JSON file cannot be used.
    #[error("{}: {}: {} ({cure})", file.display(), on_one_line(field), on_one_line(problem))]
    Field {
        /// The file.
        file: PathBuf,
        /// The field's path, such as `aperture.blades`.
        field: String,
        /// What is wrong.
        problem: String,
        /// What to do.
        cure: String,
    },
    /// The project was written by a newer version of the program.
    #[error("{}: written in format version {version}, this program reads up to {newest} (update the program)", file.display())]
    Newer {
        /// The file.
        file: PathBuf,
        /// Its version.
        version: u64,
        /// The newest version that can be read.
        newest: u64,
    },
    /// A part of the project file is damaged.
    #[error("{}: {entry}: {} ({cure})", file.display(), on_one_line(problem))]
    Entry {
        /// The file.
        file: PathBuf,
        /// The entry of the container.
        entry: String,
        /// What is wrong.
        problem: String,
        /// What to do.
        cure: String,
    },
    /// The written file did not read back the same. The previous content is still there.
    #[error("{}: not saved: the written file did not read back the same: {} (check the disk, or save elsewhere)", file.display(), on_one_line(problem))]
    Unverified {
        /// The file.
        file: PathBuf,
        /// What was wrong.
        problem: String,
    },
    /// The focus does not fit the scene.
    #[error("{}: {source}", file.display())]
    Focus {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        source: FocusError,
    },
    /// Two pictures that cannot be compared.
    #[error("the pictures are {}×{} and {}×{} (compare pictures of one size)", a[0], a[1], b[0], b[1])]
    SizesDiffer {
        /// Columns and rows of one.
        a: [u32; 2],
        /// Columns and rows of the other.
        b: [u32; 2],
    },
    /// Two pictures that lack the standard errors needed to test whether they agree.
    #[error(
        "the pictures cannot be tested for agreement: {0} (render both with --aov stderr, in passes of the ground truth)"
    )]
    Untestable(String),
}

impl ProjectError {
    /// A [`Self::Content`].
    pub(crate) fn content(file: &Path, problem: impl Into<String>, cure: impl Into<String>) -> Self {
        Self::Content { file: file.to_owned(), problem: problem.into(), cure: cure.into() }
    }
}

/// A text that may quote a file, with line breaks and other control characters escaped.
fn on_one_line(text: &str) -> String {
    let escaped = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
    text.chars().map(escaped).collect()
}

/// The remedy for an error of the file system.
fn io_cure(error: &std::io::Error) -> &'static str {
    use std::io::ErrorKind::*;
    match error.kind() {
        NotFound => "check the path",
        PermissionDenied | ReadOnlyFilesystem => "check the permissions",
        StorageFull | QuotaExceeded => "make room on the disk",
        IsADirectory => "name a file, not a folder",
        _ => "check the disk",
    }
}
