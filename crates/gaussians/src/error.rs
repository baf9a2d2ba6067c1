//! Errors of opening splats.

use progress::Cancelled;
use std::path::{Path, PathBuf};

/// Why a file of splats did not open. Displays as `FILE: what is wrong (what to do)`, on one line.
#[derive(Debug, thiserror::Error)]
pub enum GaussianError {
    /// The file or folder cannot be read.
    #[error("{}: cannot be read: {source} (check the path and its permissions)", file.display())]
    Unreadable {
        /// The file or folder.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file has no splats.
    #[error("{}: {what} (give a scene of trained Gaussian splats: .ply, .spz, .sog, .splat or .ksplat)", file.display())]
    NoSplats {
        /// The file.
        file: PathBuf,
        /// What it is instead.
        what: String,
    },
    /// The content of a file is invalid.
    #[error("{}: {place}: {what} (export the file again)", file.display())]
    Malformed {
        /// The file.
        file: PathBuf,
        /// Line, byte or part of the file.
        place: String,
        /// What is wrong there.
        what: String,
    },
    /// The file is of a version or kind that is not read.
    #[error("{}: {what} ({cure})", file.display())]
    Unsupported {
        /// The file.
        file: PathBuf,
        /// What it is.
        what: String,
        /// What to do.
        cure: &'static str,
    },
    /// The file exceeds the limit of memory.
    #[error("{}: {what} (reduce the number of splats or the degree of their colours, or raise the limit)", file.display())]
    TooBig {
        /// The file.
        file: PathBuf,
        /// What is too big, and the limit.
        what: String,
    },
    /// A scene in several files refers to a file outside its folder.
    #[error("{}: refers to {name}, which is outside its folder (put the file into the folder of meta.json)", file.display())]
    Outside {
        /// The file that refers to it.
        file: PathBuf,
        /// The name, in quotes.
        name: String,
    },
    /// Reading was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl GaussianError {
    pub(crate) fn unreadable(file: &Path, source: std::io::Error) -> Self {
        Self::Unreadable { file: file.into(), source }
    }

    pub(crate) fn malformed(file: &Path, place: impl ToString, what: impl ToString) -> Self {
        let [place, what] = [place.to_string(), what.to_string()].map(one_line);
        Self::Malformed { file: file.into(), place, what }
    }

    pub(crate) fn no_splats(file: &Path, what: impl ToString) -> Self {
        Self::NoSplats { file: file.into(), what: one_line(what.to_string()) }
    }

    pub(crate) fn unsupported(file: &Path, what: impl ToString, cure: &'static str) -> Self {
        Self::Unsupported { file: file.into(), what: one_line(what.to_string()), cure }
    }
}

fn one_line(text: String) -> String {
    text.replace(|c: char| c.is_control(), " ")
}

/// A piece of a file for a message: short, in quotes, on one line.
pub(crate) fn quoted(text: &str) -> String {
    const LONGEST: usize = 40;
    let mut short: String =
        text.chars().take(LONGEST).map(|c| if c.is_control() { '?' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        short.push('…');
    }
    format!("{short:?}")
}
