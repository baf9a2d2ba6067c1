//! A folder for the files that a reader opens by their path.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The process's folder in `$TMPDIR`, made when it is first asked for.
///
/// # Panics
/// It cannot be made.
pub fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = std::env::temp_dir().join(format!("focus-brush-fuzz-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder for the files");
        folder
    })
}

/// Writes a file of this name in the folder, and returns its path.
///
/// # Panics
/// It cannot be written.
pub fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let file = folder().join(name);
    if let Some(parent) = file.parent() {
        std::fs::create_dir_all(parent).expect("a folder for the file");
    }
    std::fs::write(&file, bytes).expect("a file");
    file
}

/// Writes files once: those beside the one that changes.
///
/// # Panics
/// They cannot be written.
pub fn once(written: &'static std::sync::Once, files: &[(&str, &[u8])]) {
    written.call_once(|| files.iter().for_each(|(name, bytes)| drop(file(name, bytes))));
}
