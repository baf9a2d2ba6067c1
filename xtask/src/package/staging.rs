//! The file tree of a package, laid out on disk before it is packed.

use super::layout::{BOOK, Installed, PROGRAM, SHARED};
use super::release::Release;
use crate::chore::{Failure, copy, execute, file_failure, repository};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Creates an empty folder for a package.
///
/// # Errors
/// The folder cannot be emptied or created.
pub fn empty_folder(release: &Release, name: &str) -> Result<PathBuf, Failure> {
    let folder = release.output.join("staging").join(name);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).map_err(|error| file_failure(&folder, &error))?;
    }
    std::fs::create_dir_all(&folder).map_err(|error| file_failure(&folder, &error))?;
    Ok(folder)
}

/// Lays out the installed files below `root`, the program without its debug information.
///
/// # Errors
/// A file cannot be copied, or `strip` fails.
pub fn lay_out(root: &Path, program: &Path) -> Result<(), Failure> {
    let placed = root.join(PROGRAM);
    copy(program, &placed)?;
    execute(Command::new("strip").arg("--strip-unneeded").arg(&placed))?;
    for Installed { from, to } in SHARED {
        copy(&repository().join(from), &root.join(to))?;
    }
    crate::book::write(&root.join(BOOK))?;
    Ok(())
}

/// Writes a file.
///
/// # Errors
/// The file cannot be written.
pub fn write(file: &Path, text: &str) -> Result<(), Failure> {
    let folder = file.parent().unwrap_or(file);
    std::fs::create_dir_all(folder).map_err(|error| file_failure(folder, &error))?;
    std::fs::write(file, text).map_err(|error| file_failure(file, &error))
}

/// Sets the permissions that files and folders have in packages, independently of the local ones.
///
/// # Errors
/// `chmod` fails.
pub fn set_rights(root: &Path) -> Result<(), Failure> {
    execute(Command::new("chmod").args(["-R", "u=rwX,go=rX"]).arg(root))
}

/// Packs a folder into an archive, under the folder's name.
///
/// # Errors
/// `tar` fails.
pub fn pack(release: &Release, folder: &Path, archive: &Path) -> Result<(), Failure> {
    let (above, name) = (folder.parent().unwrap_or(folder), folder.file_name().unwrap_or_default());
    let mut tar = Command::new("tar");
    tar.args([
        "--create",
        "--xz",
        "--sort=name",
        "--owner=0",
        "--group=0",
        "--numeric-owner",
        "--format=gnu",
    ]);
    tar.arg(format!("--mtime=@{}", release.time)).arg("--file").arg(archive).arg("-C").arg(above).arg(name);
    // For many small files, levels above the default do not improve compression.
    execute(tar.env("XZ_OPT", "-6"))
}
