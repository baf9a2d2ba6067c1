//! The archive that a wheel is: a zip whose last file, RECORD, lists all others with their checksums.

use crate::chore::{Failure, file_failure};
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Write;
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// A file of the archive.
pub struct Entry {
    pub path: String,
    pub bytes: Vec<u8>,
}

/// Writes the archive of these files and of their record.
///
/// # Errors
/// The file cannot be written.
pub fn write_archive(file: &Path, mut entries: Vec<Entry>, record_path: &str) -> Result<(), Failure> {
    let record = record(&entries, record_path);
    entries.push(Entry { path: record_path.into(), bytes: record.into_bytes() });
    let failed = |error: zip::result::ZipError| Failure::new(format!("{}: {error}", file.display()));
    let created = File::create(file).map_err(|error| file_failure(file, &error))?;
    let mut archive = ZipWriter::new(created);
    // The time of no file depends on when it is packed.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default());
    for Entry { path, bytes } in entries {
        let rights = if path.ends_with(".so") { 0o755 } else { 0o644 };
        archive.start_file(path, options.unix_permissions(rights)).map_err(failed)?;
        archive.write_all(&bytes).map_err(|error| file_failure(file, &error))?;
    }
    archive.finish().map_err(failed)?;
    Ok(())
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
