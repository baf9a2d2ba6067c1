//! The source archive: this commit with its dependencies, so that it builds without a network.

use super::release::{Release, git};
use super::staging::{empty_folder, pack, set_rights, write};
use crate::chore::{Failure, execute, file_failure, output_of};
use std::path::PathBuf;
use std::process::Command;

/// Builds the archive from the commit, ignoring other changes in the working tree.
///
/// # Errors
/// A file cannot be written, or git, cargo or tar fails.
pub fn make(release: &Release) -> Result<PathBuf, Failure> {
    let name = format!("focus-brush-{}-source", release.version);
    let folder = empty_folder(release, &name)?;
    let tree = folder.with_extension("tar");
    execute(git().args(["archive", "--format=tar", "-o"]).arg(&tree).arg("HEAD"))?;
    execute(Command::new("tar").arg("--extract").arg("--file").arg(&tree).arg("-C").arg(&folder))?;
    std::fs::remove_file(&tree).map_err(|error| file_failure(&tree, &error))?;
    let mut vendor = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    vendor.args(["vendor", "--locked", "--versioned-dirs", "vendor"]).current_dir(&folder);
    // Its output is the configuration that cargo needs.
    let sources = output_of(&mut vendor)?;
    let config = folder.join(".cargo/config.toml");
    let own = std::fs::read_to_string(&config).map_err(|error| file_failure(&config, &error))?;
    write(&config, &format!("{own}\n{}\n[net]\noffline = true\n", String::from_utf8_lossy(&sources).trim()))?;
    set_rights(&folder)?;
    let archive = release.output.join(format!("{name}.tar.xz"));
    pack(release, &folder, &archive)?;
    Ok(archive)
}
