//! Results that are not computed again: files of our own in a cache folder.
//!
//! A file is named by a checksum of all that it was made from and of the very build of the program; its contents stand before a checksum
//! of their own. One that cannot be read is as good as none, and that one cannot be written only costs time later. Where the files of
//! a section take too much, those go that were not read for the longest.

use atomic_write_file::AtomicWriteFile;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

/// A folder for results that outlive the program, or none. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct DiskCache {
    folder: Option<Arc<Path>>,
}

/// Files of one kind.
#[derive(Clone, Copy, Debug)]
pub struct CacheSection {
    /// Their folder in the cache folder, and their extension.
    pub name: &'static str,
    /// Bytes that they may take together.
    pub budget_bytes: u64,
}

/// The file of one result, whether or not it exists.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CacheEntry {
    path: PathBuf,
    name: &'static str,
    budget_bytes: u64,
}

impl DiskCache {
    /// A cache in `folder`, which is made when there is a result to keep.
    pub fn in_folder(folder: &Path) -> Self {
        Self { folder: Some(folder.into()) }
    }

    /// No cache: nothing is kept, nothing is found.
    pub const DISABLED: Self = Self { folder: None };

    /// The entry of what is made from the inputs that `add_inputs` hashes; none where nothing is kept or builds of the program cannot be
    /// told apart.
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
    /// Whether there is a file, whole or not.
    pub fn exists(&self) -> bool {
        self.path.exists()
    }

    /// What the file holds, if it is whole. It counts as used now.
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
        // Where the use cannot be noted, the file goes by when it was written.
        let file = File::options().write(true).open(&self.path);
        let _ = file.and_then(|file| file.set_modified(SystemTime::now()));
        Some(bytes)
    }

    /// Keeps bytes, and removes the files of the section that lie beyond its budget.
    pub fn write(&self, bytes: &[u8]) {
        let Some(folder) = self.path.parent() else { return };
        let written = std::fs::create_dir_all(folder).and_then(|()| {
            let mut file = AtomicWriteFile::open(&self.path)?;
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

/// Removes the files of an extension that were not looked for the longest, as many as lie beyond a budget, but not the `newest`.
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

/// Tells this build of the program from others, which may work otherwise.
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
