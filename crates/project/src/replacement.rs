//! Files that replace others once they are complete.

use atomic_write_file::AtomicWriteFile;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};

/// A new file that replaces `file` once it is committed; through a link, the file that it points to. Abandoned files
/// of killed runs are removed.
pub(crate) fn replacement(file: &Path) -> Result<AtomicWriteFile> {
    let target: PathBuf = std::fs::canonicalize(file).unwrap_or_else(|_| file.to_owned());
    if target.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    remove_abandoned(&target);
    // Another run may mistake a file that is not yet locked for an abandoned one.
    const TRIES: usize = 16;
    for _ in 0..TRIES {
        let new = AtomicWriteFile::options().read(true).open(&target)?;
        let is_others = matches!(new.as_file().try_lock(), Err(std::fs::TryLockError::WouldBlock));
        if !is_others && is_there(new.as_file())? {
            return Ok(new);
        }
    }
    Err(Error::other("other processes keep writing it"))
}

/// Number of random characters that the name of a file being written has, after a dot, in addition to that of the
/// file that it replaces and a dot in front.
const SUFFIX: usize = 6;

/// Removes abandoned replacements of `target`: files with the name of a replacement that no one holds a lock on. On
/// systems without locks they stay.
fn remove_abandoned(target: &Path) {
    let (Some(folder), Some(name)) = (target.parent(), target.file_name()) else { return };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    let left_over = entries.flatten().filter(|entry| is_replacement_name(&entry.file_name(), name));
    for path in left_over.map(|entry| entry.path()) {
        let opened = File::options().write(true).open(&path);
        if opened.is_ok_and(|file| file.try_lock().is_ok()) {
            // Another run may have removed it first.
            let _ = std::fs::remove_file(path);
        }
    }
}

fn is_replacement_name(candidate: &OsStr, name: &OsStr) -> bool {
    let (candidate, name) = (candidate.as_encoded_bytes(), name.as_encoded_bytes());
    let Some(suffix) = candidate.strip_prefix(b".").and_then(|rest| rest.strip_prefix(name)) else {
        return false;
    };
    matches!(suffix, [b'.', random @ ..] if random.len() == SUFFIX && random.iter().all(u8::is_ascii_alphanumeric))
}

/// Whether an open file still has a name.
#[cfg(unix)]
fn is_there(file: &File) -> Result<bool> {
    use std::os::unix::fs::MetadataExt;
    Ok(file.metadata()?.nlink() > 0)
}

/// Open files keep their names.
#[cfg(not(unix))]
fn is_there(_: &File) -> Result<bool> {
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn left_overs_go_and_what_is_written_stays() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let others = [
            "x.exr",
            ".x.exr",
            ".x.exr.a1B2c",
            ".x.exr.a1B2c3d",
            "x.exr.a1B2c3",
            ".y.exr.a1B2c3",
            ".x.exr.a1B2-3",
        ];
        let left_overs = [".x.exr.a1B2c3", ".x.exr.zzzzzz"];
        others.iter().chain(&left_overs).for_each(|name| std::fs::write(at(name), name).unwrap());
        let mut one = replacement(&at("x.exr")).unwrap();
        one.write_all(b"one").unwrap();
        assert!(others.iter().all(|name| at(name).exists()));
        assert!(!left_overs.iter().any(|name| at(name).exists()));
        // Of two that write at once, neither takes the other's for a left-over.
        let mut other = replacement(&at("x.exr")).unwrap();
        other.write_all(b"other").unwrap();
        one.commit().unwrap();
        other.commit().unwrap();
        assert_eq!(std::fs::read(at("x.exr")).unwrap(), b"other");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), others.len());
    }

    #[test]
    fn a_folder_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(replacement(folder.path()).unwrap_err().kind(), ErrorKind::IsADirectory);
    }
}
