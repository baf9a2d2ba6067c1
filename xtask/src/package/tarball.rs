//! The relocatable archive: the program runs from wherever it is unpacked.

use super::release::Release;
use super::staging::{empty_folder, lay_out, pack, set_rights, write};
use crate::chore::Failure;
use std::path::{Path, PathBuf};

/// Builds the archive.
///
/// # Errors
/// A file cannot be written, or `tar` fails.
pub fn make(release: &Release, program: &Path) -> Result<PathBuf, Failure> {
    let name = format!("focus-brush-{}-linux-{}", release.version, std::env::consts::ARCH);
    let folder = empty_folder(release, &name)?;
    lay_out(&folder, program)?;
    write(&folder.join("READ_ME_FIRST.txt"), READ_ME)?;
    set_rights(&folder)?;
    let archive = release.output.join(format!("{name}.tar.xz"));
    pack(release, &folder, &archive)?;
    Ok(archive)
}

const READ_ME: &str = "\
Focus Brush runs from here:

    bin/focus-brush                 opens the window with the demo
    bin/focus-brush doctor          says what is missing, and how to get it

To have it among the programs of your desktop, with its icon and its kinds of files, copy bin and share
into ~/.local, and run update-desktop-database ~/.local/share/applications and
update-mime-database ~/.local/share/mime.

What it does is told in share/doc/focus-brush/README.md.
";
