#![doc = include_str!("../README.md")]

use atomic_write_file::AtomicWriteFile;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A new file that replaces another once it is committed. If it is dropped before, the other one stays as it was.
#[derive(Debug)]
pub struct AtomicFile {
    new: AtomicWriteFile,
    target: PathBuf,
}

/// Replaces the file at `path`, or creates it, with `bytes`.
///
/// # Errors
/// The file cannot be written; the old one, if any, is unchanged.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes)?;
    file.commit()
}

impl AtomicFile {
    /// Begins the file that is to replace `path`; through a link, the file that it points to. Files that killed programs left behind are
    /// removed.
    ///
    /// # Errors
    /// `path` is a folder, or its folder cannot be written to.
    pub fn create(path: &Path) -> Result<Self> {
        let target: PathBuf = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if target.is_dir() {
            return Err(ErrorKind::IsADirectory.into());
        }
        remove_abandoned(&target);
        // Another program may take a file that is not yet locked for an abandoned one, and remove it.
        const TRIES: usize = 16;
        for _ in 0..TRIES {
            let opened = AtomicWriteFile::options().read(true).open(&target);
            let new = opened.inspect_err(|_| remove_abandoned(&target))?;
            let is_others = matches!(new.as_file().try_lock(), Err(std::fs::TryLockError::WouldBlock));
            if !is_others && !was_removed(&new)? {
                return Ok(Self { new, target });
            }
        }
        Err(Error::other("other processes keep writing it"))
    }

    /// Writes what was written so far to the disk.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn sync_all(&self) -> Result<()> {
        self.new.as_file().sync_all()
    }

    /// The number of bytes of the file so far.
    ///
    /// # Errors
    /// The file cannot be examined.
    pub fn byte_len(&self) -> Result<u64> {
        Ok(self.new.as_file().metadata()?.len())
    }

    /// Completes the file: writes it to the disk and puts it in the old one's place.
    ///
    /// # Errors
    /// It cannot be written or renamed. The old file is unchanged then, unless only the folder could not be written to the disk.
    pub fn commit(self) -> Result<()> {
        // A file that cannot be written to the disk is removed when it is dropped; one that has a name already and cannot be renamed, is
        // abandoned.
        self.sync_all()?;
        let Self { new, target } = self;
        new.commit().inspect_err(|_| remove_abandoned(&target))
    }
}

impl Read for AtomicFile {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        self.new.as_file().read(buffer)
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.new.as_file().write(bytes)
    }

    fn flush(&mut self) -> Result<()> {
        self.new.as_file().flush()
    }
}

impl Seek for AtomicFile {
    fn seek(&mut self, position: SeekFrom) -> Result<u64> {
        self.new.as_file().seek(position)
    }
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

/// Whether another program removed the file since it was opened: it had a name, and has none now.
#[cfg(unix)]
fn was_removed(new: &AtomicWriteFile) -> Result<bool> {
    use std::os::unix::fs::MetadataExt;
    Ok(new.as_file().metadata()?.nlink() == 0 && !never_had_a_name(new))
}

/// Whether Linux shows the open file under the name that it gives to files without one (`#` and their number).
#[cfg(unix)]
fn never_had_a_name(new: &AtomicWriteFile) -> bool {
    use std::os::fd::AsRawFd;
    let shown = std::fs::read_link(format!("/proc/self/fd/{}", new.as_file().as_raw_fd()));
    shown.is_ok_and(|path| path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"#")))
}

/// Open files keep their names.
#[cfg(not(unix))]
fn was_removed(_: &AtomicWriteFile) -> Result<bool> {
    Ok(false)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let mut one = AtomicFile::create(&at("x.exr")).unwrap();
        one.write_all(b"one").unwrap();
        assert!(others.iter().all(|name| at(name).exists()));
        assert!(!left_overs.iter().any(|name| at(name).exists()));
        // Of two that write at once, neither takes the other's for a left-over.
        let mut other = AtomicFile::create(&at("x.exr")).unwrap();
        other.write_all(b"other").unwrap();
        one.commit().unwrap();
        other.commit().unwrap();
        assert_eq!(std::fs::read(at("x.exr")).unwrap(), b"other");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), others.len());
    }

    #[test]
    fn a_file_that_cannot_be_put_in_place_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.exr");
        let mut file = AtomicFile::create(&path).unwrap();
        file.write_all(b"x").unwrap();
        // A folder of that name appears meanwhile, which a file cannot replace.
        std::fs::create_dir(&path).unwrap();
        std::fs::write(path.join("inside"), "").unwrap();
        assert!(file.commit().is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        drop(AtomicFile::create(&folder.path().join("y.exr")).unwrap());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(AtomicFile::create(folder.path()).unwrap_err().kind(), ErrorKind::IsADirectory);
    }
}
