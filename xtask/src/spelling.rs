//! Spelling: `typos` over code and docs, with the words of `_typos.toml`.
//!
//! Where it is not installed, its wheel is taken from PyPI into `target/typos`. Without Python, or without a
//! network, the check is skipped, which is said.

use crate::chore::{Failure, execute, repository};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The version that CI uses: another may know other words.
const VERSION: &str = "1.52.0";

/// Checks the repository.
///
/// # Errors
/// A word is misspelled.
pub fn check() -> Result<(), Failure> {
    match installed().or_else(install) {
        Some(typos) => execute(Command::new(typos).current_dir(repository())),
        None => {
            eprintln!("SKIPPED: spelling (install typos: pip install typos=={VERSION})");
            Ok(())
        }
    }
}

/// The program on the path, if it is there.
fn installed() -> Option<PathBuf> {
    succeeds(Command::new("typos").arg("--version")).then(|| "typos".into())
}

/// The program in a folder of its own below `target`, installed now or before.
fn install() -> Option<PathBuf> {
    let folder = repository().join("target/typos");
    let program = folder.join("bin/typos");
    if !program.exists() {
        let pip = folder.join("bin/pip");
        let is_ready = succeeds(Command::new("python3").args([Path::new("-m"), Path::new("venv"), &folder]))
            && succeeds(Command::new(pip).args(["install", "--quiet", &format!("typos=={VERSION}")]));
        if !is_ready {
            return None;
        }
    }
    Some(program)
}

/// Runs a command without output. Returns whether it succeeded.
fn succeeds(command: &mut Command) -> bool {
    command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}
