//! The capture's folder, and what may be opened in it: regular files and folders inside, links followed.

use crate::CaptureError;
use std::path::{Path, PathBuf};

/// A folder outside which nothing is read.
#[derive(Clone, Debug)]
pub(crate) struct Folder {
    /// Canonical.
    root: PathBuf,
    /// The path given by the caller, for messages.
    pub shown: PathBuf,
}

/// What a path refers to.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum EntryKind {
    File,
    Folder,
    /// A link that leads outside.
    Outside,
}

impl Folder {
    /// Opens a folder; links in its path are resolved.
    ///
    /// # Errors
    /// It cannot be read, or is no folder.
    pub fn open(path: &Path) -> Result<Self, CaptureError> {
        let root = path.canonicalize().map_err(|source| CaptureError::unreadable(path, source))?;
        if !root.is_dir() {
            let source = std::io::ErrorKind::NotADirectory.into();
            return Err(CaptureError::unreadable(path, source));
        }
        Ok(Self { root, shown: path.into() })
    }

    /// What a path below the folder refers to; `None` if it does not exist.
    pub fn entry_kind(&self, path: &Path) -> Option<EntryKind> {
        let real = path.canonicalize().ok()?;
        match real.metadata().ok()? {
            _ if !real.starts_with(&self.root) => Some(EntryKind::Outside),
            data if data.is_file() => Some(EntryKind::File),
            data if data.is_dir() => Some(EntryKind::Folder),
            _ => None,
        }
    }

    /// Whether the path is a regular file inside the folder, links resolved.
    pub fn has_file(&self, path: &Path) -> bool {
        self.entry_kind(path) == Some(EntryKind::File)
    }

    /// The entries of a folder inside, sorted by name, with the kind of each; links that lead outside are included.
    pub fn entries(&self, path: &Path) -> Vec<(PathBuf, EntryKind)> {
        /// More entries are no folder of a capture.
        const MAX_ENTRIES: usize = 200_000;
        let Ok(entries) = std::fs::read_dir(path) else { return Vec::new() };
        let of_entry = |entry: std::fs::DirEntry| {
            let (path, kind) = (entry.path(), entry.file_type().ok()?);
            let entry_kind = match () {
                () if kind.is_file() => EntryKind::File,
                () if kind.is_dir() => EntryKind::Folder,
                () => self.entry_kind(&path)?,
            };
            Some((path, entry_kind))
        };
        let mut entries: Vec<_> = entries.take(MAX_ENTRIES).flatten().filter_map(of_entry).collect();
        entries.sort_by(|(a, _), (b, _)| a.cmp(b));
        entries
    }

    /// All regular files below a path, at most `depth` folders deep, at most `max_files`, folder by folder.
    pub fn files(&self, path: &Path, depth: usize, max_files: usize) -> Vec<PathBuf> {
        let mut files = Vec::new();
        let mut folders = vec![(path.to_path_buf(), 0)];
        let mut next = 0;
        while let Some((folder, level)) = folders.get(next).cloned() {
            next += 1;
            for (path, kind) in self.entries(&folder) {
                match kind {
                    EntryKind::File if files.len() < max_files => files.push(path),
                    // Links to folders could form cycles.
                    EntryKind::Folder if level < depth && folders.len() < max_files && !path.is_symlink() => {
                        folders.push((path, level + 1));
                    }
                    _ => {}
                }
            }
            if files.len() >= max_files {
                break;
            }
        }
        files
    }
}

/// The extension of a file, lower case; empty if it has none.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_that_lead_outside_are_distinguished() {
        let outside = tempfile::tempdir().unwrap();
        std::fs::write(outside.path().join("a"), "a").unwrap();
        let inside = tempfile::tempdir().unwrap();
        let folder = Folder::open(inside.path()).unwrap();
        std::fs::create_dir(inside.path().join("sub")).unwrap();
        std::fs::write(inside.path().join("sub/b"), "b").unwrap();
        assert_eq!(folder.entry_kind(&inside.path().join("sub")), Some(EntryKind::Folder));
        assert_eq!(folder.entry_kind(&inside.path().join("sub/b")), Some(EntryKind::File));
        assert_eq!(folder.entry_kind(&inside.path().join("sub/c")), None);
        assert_eq!(folder.entry_kind(&inside.path().join("../")), Some(EntryKind::Outside));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(outside.path(), inside.path().join("link")).unwrap();
            assert_eq!(folder.entry_kind(&inside.path().join("link/a")), Some(EntryKind::Outside));
            std::os::unix::fs::symlink(inside.path(), inside.path().join("sub/round")).unwrap();
            assert_eq!(folder.files(inside.path(), 9, 100), [inside.path().join("sub/b")]);
        }
        assert!(Folder::open(&inside.path().join("sub/b")).is_err());
    }
}
