//! The container of a project: a ZIP of named entries, read within limits.

use crate::ProjectError;
use std::io::{Cursor, Read, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipArchive, ZipWriter};

/// Maximum number of entries of a project.
const MAX_ENTRIES: usize = 256;

/// The remedy for a damaged project.
pub(crate) const DAMAGED_CURE: &str =
    "restore the file from a backup, or open its .recovery file if there is one";

/// Packs the entries, in order, compressed. The same entries give the same bytes, on any system.
pub(crate) fn pack(entries: &[(String, Vec<u8>)]) -> Result<Vec<u8>, std::io::Error> {
    // The fastest level: floats hardly compress further, and saving must be quick.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .compression_level(Some(1))
        .last_modified_time(DateTime::default())
        .system(System::Unix);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        zip.start_file(name.as_str(), options.large_file(bytes.len() as u64 >= u32::MAX as u64))?;
        zip.write_all(bytes)?;
    }
    Ok(zip.finish()?.into_inner())
}

/// A packed file that is being read.
pub(crate) struct Container<'a> {
    file: &'a Path,
    archive: ZipArchive<Cursor<&'a [u8]>>,
}

impl<'a> Container<'a> {
    /// Opens the bytes of `file`, a ZIP archive.
    ///
    /// # Errors
    /// It is none, is damaged, or has too many entries.
    pub fn open(file: &'a Path, bytes: &'a [u8]) -> Result<Self, ProjectError> {
        let archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| {
            ProjectError::content(file, format!("is not a complete project file: {error}"), DAMAGED_CURE)
        })?;
        if archive.len() > MAX_ENTRIES {
            let problem = format!("has {} entries, more than {MAX_ENTRIES}", archive.len());
            return Err(ProjectError::content(file, problem, DAMAGED_CURE));
        }
        Ok(Self { file, archive })
    }

    /// An error about an entry of the file: what is wrong with it.
    pub fn error(&self, entry: &str, problem: impl Into<String>) -> ProjectError {
        let (file, entry) = (self.file.to_owned(), entry.to_owned());
        ProjectError::Entry { file, entry, problem: problem.into(), cure: DAMAGED_CURE.to_string() }
    }

    /// Reads an entry of at most `limit` bytes.
    ///
    /// # Errors
    /// The entry is missing, damaged, or longer.
    pub fn read(&mut self, entry: &str, limit: u64) -> Result<Vec<u8>, ProjectError> {
        let read = match self.archive.by_name(entry) {
            // The size that the entry declares is not trusted: reading stops at the limit.
            Ok(stored) => {
                let mut bytes = Vec::new();
                stored
                    .take(limit + 1)
                    .read_to_end(&mut bytes)
                    .map(|_| bytes)
                    .map_err(|error| error.to_string())
            }
            Err(error) => Err(error.to_string()),
        };
        match read {
            Ok(bytes) if bytes.len() as u64 <= limit => Ok(bytes),
            Ok(_) => Err(self.error(entry, format!("is larger than the {limit} bytes it may have"))),
            Err(problem) => Err(self.error(entry, format!("cannot be unpacked: {problem}"))),
        }
    }
}
