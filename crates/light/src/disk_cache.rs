//! Results cached as files in a folder, so that they are not computed again.
//!
//! A file's name is a checksum of all its inputs and of the build of the program; its contents are followed by a checksum of their own. A
//! file that cannot be read counts as missing, and a failed write only costs time later. If the files of a section exceed its budget, the
//! least recently used are removed.

use atomic_file::AtomicFile;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

/// A cache of results on disk, or none. Clones share its folder.
#[derive(Clone, Debug, Default)]
pub struct DiskCache {
    folder: Option<Arc<Path>>,
}

/// A section of the cache: files of one kind.
#[derive(Clone, Copy, Debug)]
pub struct CacheSection {
    /// The name of its folder in the cache folder, and the extension of its files.
    pub name: &'static str,
    /// The total size that its files may have, bytes.
    pub budget_bytes: u64,
}

/// The file of one result, which may not exist yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CacheEntry {
    path: PathBuf,
    name: &'static str,
    budget_bytes: u64,
}

impl DiskCache {
    /// A cache in `folder`, which is created when the first result is written.
    pub fn in_folder(folder: &Path) -> Self {
        Self { folder: Some(folder.into()) }
    }

    /// No cache: nothing is stored.
    pub const DISABLED: Self = Self { folder: None };

    /// The entry of the result whose inputs `add_inputs` hashes; `None` if the cache is disabled, or the build of the program cannot be
    /// identified.
    pub fn entry(&self, section: CacheSection, add_inputs: impl FnOnce(&mut Sha256)) -> Option<CacheEntry> {
        let folder = self.folder.as_ref()?;
        let mut hash = Sha256::new();
        hash.update(build_id()?);
        add_inputs(&mut hash);
        let name = hex::encode(hash.finalize());
        let CacheSection { name: section, budget_bytes } = section;
        let path = folder.join(section).join(name).with_extension(section);
        Some(CacheEntry { path, name: section, budget_bytes })
    }
}

impl CacheEntry {
    /// Whether the file exists; it may be damaged.
    pub fn exists(&self) -> bool {
        self.path.exists()
    }

    /// Reads the file's contents, if it exists and is undamaged, and marks it as used now.
    pub fn read(&self) -> Option<Vec<u8>> {
        if std::fs::metadata(&self.path).ok()?.len() > self.budget_bytes {
            return None;
        }
        let mut bytes = std::fs::read(&self.path).ok()?;
        let content_len = bytes.len().checked_sub(CHECKSUM_BYTES)?;
        if Sha256::digest(&bytes[..content_len]).as_slice() != &bytes[content_len..] {
            return None;
        }
        bytes.truncate(content_len);
        mark_used(&self.path);
        Some(bytes)
    }

    /// Writes `bytes` to the file, and removes the least recently used files of its section beyond the budget. A failed write is ignored.
    pub fn write(&self, bytes: &[u8]) {
        let Some(folder) = self.path.parent() else { return };
        let written = std::fs::create_dir_all(folder).and_then(|()| {
            let mut file = AtomicFile::create(&self.path)?;
            file.write_all(bytes)?;
            file.write_all(&Sha256::digest(bytes))?;
            file.commit()
        });
        if written.is_ok() {
            evict_oldest(folder, self.name, self.budget_bytes, &self.path);
        }
    }
}

const CHECKSUM_BYTES: usize = 32;

/// Marks a file of a cache as used now. If this fails, it keeps the time of its last use or of its writing.
pub fn mark_used(path: &Path) {
    // Windows changes times only through a file that may be written to.
    let file = File::options().write(true).open(path);
    let _ = file.and_then(|file| file.set_modified(SystemTime::now()));
}

/// Removes the least recently used files of an extension in `folder`, until the rest fit `budget_bytes`. The `newest` always stays.
pub fn evict_oldest(folder: &Path, extension: &str, budget_bytes: u64, newest: &Path) {
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

/// Identifies this build of the program, by the size and modification time of its file: another build may compute other results.
pub fn build_id() -> Option<String> {
    let program = std::env::current_exe().and_then(std::fs::metadata).ok()?;
    let modified = program.modified().ok()?.duration_since(SystemTime::UNIX_EPOCH).ok()?;
    Some(format!("{} {modified:?}", program.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn the_least_recently_used_files_are_removed_first() {
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
    fn damaged_entries_are_not_read() {
        const SECTION: CacheSection = CacheSection { name: "numbers", budget_bytes: 1000 };
        let folder = tempfile::tempdir().unwrap();
        let cache = DiskCache::in_folder(folder.path());
        let entry = cache.entry(SECTION, |hash| hash.update("one")).unwrap();
        assert_ne!(cache.entry(SECTION, |hash| hash.update("two")).unwrap(), entry);
        assert!(DiskCache::DISABLED.entry(SECTION, |hash| hash.update("one")).is_none());
        assert!(entry.read().is_none());
        entry.write(b"numbers");
        assert_eq!(entry.read().unwrap(), b"numbers");
        let valid_bytes = std::fs::read(&entry.path).unwrap();
        std::fs::write(&entry.path, &valid_bytes[..7]).unwrap();
        assert!(entry.read().is_none());
        let flipped: Vec<_> = valid_bytes.iter().enumerate().map(|(k, b)| b ^ u8::from(k == 3)).collect();
        std::fs::write(&entry.path, flipped).unwrap();
        assert!(entry.read().is_none());
    }
}
