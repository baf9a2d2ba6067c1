//! The archive that a wheel is: a zip whose last file, RECORD, lists all others with their checksums.

use crate::chore::Failure;
use crate::zip_archive::{Entry, write_zip};
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use sha2::{Digest, Sha256};
use std::path::Path;

/// Writes the archive of these files and of their record.
///
/// # Errors
/// The file cannot be written.
pub fn write_archive(file: &Path, mut entries: Vec<Entry>, record_path: &str) -> Result<(), Failure> {
    let record = record(&entries, record_path);
    entries.push(Entry { path: record_path.into(), bytes: record.into_bytes() });
    write_zip(file, entries)
}

/// RECORD: path, checksum and size of every file, of itself the path alone.
fn record(entries: &[Entry], own_path: &str) -> String {
    let line = |Entry { path, bytes }: &Entry| {
        format!("{path},sha256={},{}\n", URL_SAFE_NO_PAD.encode(Sha256::digest(bytes)), bytes.len())
    };
    entries.iter().map(line).collect::<String>() + &format!("{own_path},,\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_record_lists_checksums_as_pip_computes_them() {
        let entry = Entry { path: "a/b.py".into(), bytes: Vec::new() };
        // base64.urlsafe_b64encode(hashlib.sha256(b"").digest()).rstrip(b"=")
        let empty = "47DEQpj8HBSa-_TImW-5JCeuQeRkm5NMpJWZG3hSuFU";
        assert_eq!(record(&[entry], "a/RECORD"), format!("a/b.py,sha256={empty},0\na/RECORD,,\n"));
    }
}
