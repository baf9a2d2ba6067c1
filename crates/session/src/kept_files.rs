//! What was worked out once and is not worked out again: files of our own in the user's cache folder.
//!
//! A file is named by a checksum of all that it was made from and of the very build of the program; its contents stand behind a checksum
//! of their own. One that cannot be read is as good as none, and that one cannot be written only costs time later. Where files of a
//! kind take too much, those go that were not looked for the longest.

use atomic_write_file::AtomicWriteFile;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::SystemTime;

/// Files of one kind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DiskCache {
    /// Their folder in the cache folder, and their extension.
    pub name: &'static str,
    /// Bytes that they may take together.
    pub budget_bytes: u64,
}

/// Where they are from one run of the program to the next.
static CACHE_FOLDER: OnceLock<PathBuf> = OnceLock::new();

/// Has what was worked out (irradiance, light from photographs, atlases) kept in a folder from one run of the program to the next; the
/// first one that is named counts. Without one nothing is kept.
pub fn set_cache_folder(folder: PathBuf) {
    let _ = CACHE_FOLDER.set(folder);
}

impl DiskCache {
    /// The file of what is made from what `made_from` adds; none where nothing is kept or builds of the program cannot be told apart.
    pub fn entry_path(&self, add_inputs: impl FnOnce(&mut Sha256)) -> Option<PathBuf> {
        self.entry_path_in(CACHE_FOLDER.get()?, add_inputs)
    }

    /// The same in another cache folder.
    pub fn entry_path_in(&self, folder: &Path, add_inputs: impl FnOnce(&mut Sha256)) -> Option<PathBuf> {
        let mut hash = Sha256::new();
        hash.update(build_id()?);
        add_inputs(&mut hash);
        let name: String = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        Some(folder.join(self.name).join(name).with_extension(self.name))
    }

    /// What a file holds, if it is whole.
    pub fn read(&self, path: &Path) -> Option<Vec<u8>> {
        if std::fs::metadata(path).ok()?.len() > self.budget_bytes {
            return None;
        }
        let mut bytes = std::fs::read(path).ok()?;
        let content_len = bytes.len().checked_sub(CHECKSUM_BYTES)?;
        if Sha256::digest(&bytes[..content_len]).as_slice() != &bytes[content_len..] {
            return None;
        }
        bytes.truncate(content_len);
        // It was looked for: it goes last. Where that cannot be noted, it goes by when it was written.
        let _ = File::options().write(true).open(path).and_then(|file| file.set_modified(SystemTime::now()));
        Some(bytes)
    }

    /// Keeps bytes in a file.
    pub fn write(&self, path: &Path, bytes: &[u8]) {
        let Some(folder) = path.parent() else { return };
        let written = std::fs::create_dir_all(folder).and_then(|()| {
            let mut file = AtomicWriteFile::open(path)?;
            file.write_all(bytes)?;
            file.write_all(&Sha256::digest(bytes))?;
            file.commit()
        });
        if written.is_ok() {
            evict_oldest(folder, self.name, self.budget_bytes, path);
        }
    }
}

const CHECKSUM_BYTES: usize = 32;

/// Removes the files of an extension that were not looked for the longest, as many as lie beyond a budget, but not the `newest`.
pub(crate) fn evict_oldest(folder: &Path, extension: &str, budget_bytes: u64, newest: &Path) {
    let Ok(listing) = std::fs::read_dir(folder) else { return };
    let has_extension =
        |path: &PathBuf| path.extension().is_some_and(|path_extension| path_extension == extension);
    let paths = listing.filter_map(|entry| Some(entry.ok()?.path())).filter(has_extension);
    let mut files: Vec<_> = paths
        .filter_map(|path| {
            let metadata = path.metadata().ok()?;
            Some((metadata.modified().ok()?, metadata.len(), path))
        })
        .collect();
    files.sort();
    let mut bytes: u64 = files.iter().map(|(_, bytes, _)| bytes).sum();
    for (_, size, path) in files.iter().filter(|(.., path)| path != newest) {
        if bytes <= budget_bytes {
            return;
        }
        if std::fs::remove_file(path).is_ok() {
            bytes -= size;
        }
    }
}

/// Tells this build of the program from others, which may work otherwise.
pub(crate) fn build_id() -> Option<String> {
    let program = std::env::current_exe().and_then(std::fs::metadata).ok()?;
    let modified = program.modified().ok()?.duration_since(SystemTime::UNIX_EPOCH).ok()?;
    Some(format!("{} {modified:?}", program.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn what_was_not_looked_for_the_longest_goes_first() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, age: u64| {
            let path = folder.path().join(name);
            std::fs::write(&path, [0; 100]).unwrap();
            let file = File::options().write(true).open(&path).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(age)).unwrap();
            path
        };
        let (old, young) = (write("old.salf", 90), write("young.salf", 20));
        let other = write("notes.txt", 500);
        let newest = write("newest.salf", 100);
        evict_oldest(folder.path(), "salf", 250, &newest);
        assert!(!old.exists() && young.exists() && newest.exists() && other.exists());
        evict_oldest(folder.path(), "salf", 250, &newest);
        assert!(young.exists(), "what is left is within the budget");
    }

    #[test]
    fn what_is_damaged_is_as_good_as_none() {
        const CACHE: DiskCache = DiskCache { name: "numbers", budget_bytes: 1000 };
        let folder = tempfile::tempdir().unwrap();
        let entry = CACHE.entry_path_in(folder.path(), |hash| hash.update("one")).unwrap();
        assert_ne!(CACHE.entry_path_in(folder.path(), |hash| hash.update("two")).unwrap(), entry);
        assert!(CACHE.read(&entry).is_none());
        CACHE.write(&entry, b"numbers");
        assert_eq!(CACHE.read(&entry).unwrap(), b"numbers");
        let valid_bytes = std::fs::read(&entry).unwrap();
        std::fs::write(&entry, &valid_bytes[..7]).unwrap();
        assert!(CACHE.read(&entry).is_none());
        std::fs::write(
            &entry,
            valid_bytes.iter().enumerate().map(|(k, b)| b ^ u8::from(k == 3)).collect::<Vec<_>>(),
        )
        .unwrap();
        assert!(CACHE.read(&entry).is_none());
    }
}
