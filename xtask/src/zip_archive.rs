//! Zip archives whose bytes depend on nothing but their files.

use crate::chore::{Failure, file_failure};
use std::fs::File;
use std::io::Write;
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

/// A file of the archive.
pub struct Entry {
    /// With slashes.
    pub path: String,
    pub bytes: Vec<u8>,
}

/// Writes the archive of these files, in this order.
///
/// # Errors
/// The file cannot be written.
pub fn write_zip(file: &Path, entries: Vec<Entry>) -> Result<(), Failure> {
    let failed = |error: zip::result::ZipError| Failure::new(format!("{}: {error}", file.display()));
    let created = File::create(file).map_err(|error| file_failure(file, &error))?;
    let mut archive = ZipWriter::new(created);
    // Nothing depends on when or where it is packed.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .system(System::Unix);
    for Entry { path, bytes } in entries {
        let rights = if path.ends_with(".so") || path.ends_with(".exe") { 0o755 } else { 0o644 };
        archive.start_file(path, options.unix_permissions(rights)).map_err(failed)?;
        archive.write_all(&bytes).map_err(|error| file_failure(file, &error))?;
    }
    archive.finish().map_err(failed)?;
    Ok(())
}
