//! Reading whole files within limits, and writing them atomically.

use crate::ProjectError;
use atomic_file::AtomicFile;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Maximum size of a file, bytes.
const MAX_FILE_BYTES: u64 = 4 << 30;

/// Maximum size of a text file, bytes.
const MAX_TEXT_BYTES: u64 = 64 << 20;

/// The whole file.
pub(crate) fn read_bytes(file: &Path) -> Result<Vec<u8>, ProjectError> {
    read_limited(file, MAX_FILE_BYTES)
}

/// The whole file as text; a byte order mark is dropped.
pub(crate) fn read_text(file: &Path) -> Result<String, ProjectError> {
    let bytes = read_limited(file, MAX_TEXT_BYTES)?;
    let text = String::from_utf8(bytes)
        .map_err(|_| ProjectError::content(file, "is not text", "save it as UTF-8 JSON"))?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

fn read_limited(file: &Path, limit: u64) -> Result<Vec<u8>, ProjectError> {
    let error = |source| ProjectError::Read { file: file.to_owned(), source };
    let mut bytes = Vec::new();
    File::open(file).map_err(error)?.take(limit + 1).read_to_end(&mut bytes).map_err(error)?;
    if bytes.len() as u64 > limit {
        let problem = format!("is larger than {} MiB", limit >> 20);
        return Err(ProjectError::content(file, problem, "is it the right file?"));
    }
    Ok(bytes)
}

/// Writes the file atomically: afterwards it holds either all of `bytes` or what it held before.
pub(crate) fn write_bytes(file: &Path, bytes: &[u8]) -> Result<(), ProjectError> {
    write_verified(file, bytes, |_| Ok(()))
}

/// Writes the file, reads it back from the disk and replaces the old one only if it holds `bytes` and `verify`
/// accepts it.
pub(crate) fn write_verified(
    file: &Path,
    bytes: &[u8],
    verify: impl FnOnce(&[u8]) -> Result<(), String>,
) -> Result<(), ProjectError> {
    let error = |source| ProjectError::Write { file: file.to_owned(), source };
    let mut new = AtomicFile::create(file).map_err(error)?;
    let written = new.write_all(bytes).and_then(|()| new.sync_all());
    written.map_err(error)?;
    let mut back = Vec::with_capacity(bytes.len());
    new.seek(SeekFrom::Start(0)).and_then(|_| new.read_to_end(&mut back)).map_err(error)?;
    let problem = if back != bytes { Err("its bytes differ".to_string()) } else { verify(&back) };
    match problem {
        Ok(()) => new.commit().map_err(error),
        Err(problem) => Err(ProjectError::Unverified { file: file.to_owned(), problem }),
    }
}

/// `file` with `suffix` appended to its whole name.
pub(crate) fn with_suffix(file: &Path, suffix: &str) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(suffix);
    name.into()
}

/// The file's extension in lower case; empty if it has none.
pub(crate) fn extension(file: &Path) -> String {
    file.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}
