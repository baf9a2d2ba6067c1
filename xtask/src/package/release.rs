//! The packaged release: a version with the time of its commit.

use crate::chore::{Failure, output_of, repository};
use std::path::PathBuf;
use std::process::Command;

/// The packaged release.
pub struct Release {
    pub version: String,
    /// Time of the commit, seconds since 1970; all files in archives get it.
    pub time: String,
    /// Folder of the packages.
    pub output: PathBuf,
}

impl Release {
    /// # Errors
    /// Git fails.
    pub fn of_commit() -> Result<Self, Failure> {
        let output = target().join("package");
        std::fs::create_dir_all(&output).map_err(|e| Failure::new(format!("{}: {e}", output.display())))?;
        let time = output_of(git().args(["log", "-1", "--format=%ct"]))?;
        Ok(Self {
            version: env!("CARGO_PKG_VERSION").into(),
            time: String::from_utf8_lossy(&time).trim().into(),
            output,
        })
    }
}

/// Git, in this repository.
pub fn git() -> Command {
    let mut command = Command::new("git");
    command.arg("-C").arg(repository());
    command
}

/// Cargo's target folder.
pub fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| repository().join("target"), PathBuf::from)
}
