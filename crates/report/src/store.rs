//! Results on disk: each is written immediately, so that an interrupted run resumes.

use serde::Serialize;
use serde::de::DeserializeOwned;
use session::SessionError;
use std::path::{Path, PathBuf};

/// A folder of results, each a JSON file whose name includes a fingerprint of its inputs.
pub struct Store {
    folder: PathBuf,
}

impl Store {
    /// The store in `folder`, which is created if necessary.
    ///
    /// # Errors
    /// The folder cannot be created.
    pub fn open(folder: &Path) -> Result<Self, SessionError> {
        std::fs::create_dir_all(folder).map_err(|error| SessionError::io(folder, &error))?;
        Ok(Self { folder: folder.to_owned() })
    }

    /// A file that belongs to a result.
    pub fn file(&self, name: &str, extension: &str) -> PathBuf {
        self.folder.join(format!("{name}.{extension}"))
    }

    /// A result, if it exists and can be read; otherwise it has to be computed again.
    pub fn get<T: DeserializeOwned>(&self, name: &str) -> Option<T> {
        let bytes = std::fs::read(self.file(name, "json")).ok()?;
        serde_json::from_slice(&bytes).ok()
    }

    /// Saves a result.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn put<T: Serialize>(&self, name: &str, result: &T) -> Result<(), SessionError> {
        write_atomically(&self.file(name, "json"), &to_json(result)?)
    }
}

/// A value as pretty-printed JSON.
///
/// # Errors
/// The value is not representable as JSON.
pub fn to_json<T: Serialize>(value: &T) -> Result<Vec<u8>, SessionError> {
    let mut text = serde_json::to_vec_pretty(value)
        .map_err(|error| SessionError::Internal(format!("a result cannot be written as JSON: {error}")))?;
    text.push(b'\n');
    Ok(text)
}

/// Writes a file atomically: it holds either all of `bytes` or its previous contents.
///
/// # Errors
/// The file cannot be written.
pub fn write_atomically(file: &Path, bytes: &[u8]) -> Result<(), SessionError> {
    atomic_file::write(file, bytes).map_err(|error| SessionError::io(file, &error))
}

/// Writes files into `folder`. Returns them.
///
/// # Errors
/// A file cannot be written.
pub fn write_files<'a>(
    folder: &Path,
    files: impl IntoIterator<Item = (&'a str, Vec<u8>)>,
) -> Result<Vec<PathBuf>, SessionError> {
    let write = |(name, bytes): (&str, Vec<u8>)| {
        let file = folder.join(name);
        write_atomically(&file, &bytes)?;
        Ok(file)
    };
    files.into_iter().map(write).collect()
}

/// `text` as part of a file name: letters, digits, dots and dashes.
pub fn file_name_part(text: &str) -> String {
    text.chars().map(|c| if c.is_alphanumeric() || c == '.' { c } else { '-' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_is_got_and_what_is_broken_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(&folder.path().join("new/store")).unwrap();
        assert_eq!(store.get::<Vec<f64>>("a"), None);
        store.put("a", &vec![0.1, 1e-17]).unwrap();
        assert_eq!(store.get::<Vec<f64>>("a"), Some(vec![0.1, 1e-17]));
        std::fs::write(store.file("a", "json"), "[0.1, 1e").unwrap();
        assert_eq!(store.get::<Vec<f64>>("a"), None);
        assert_eq!(file_name_part("my scene/2"), "my-scene-2");
    }
}
