//! A part of a picture that is yet to be merged: sections of numbers, their description, and a seal.
//!
//! ```text
//! "focus-brush part 1\n"
//! sections                  32-bit numbers, little-endian
//! description               JSON, UTF-8
//! its length                u64, little-endian
//! SHA-256                   of everything before it, 32 bytes
//! ```
//!
//! A part is written sequentially, and exists only once it is complete.

use crate::ProjectError;
use atomic_file::AtomicFile;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

const MAGIC: &[u8] = b"focus-brush part 1\n";

/// What a part of any version begins with; its version in digits and a line break follow.
const MAGIC_OF_ANY_VERSION: &[u8] = b"focus-brush part ";

/// The version that is written.
const VERSION: u64 = 1;

/// Bytes after the description: its length, and the seal.
const END: u64 = 8 + 32;

/// Maximum length of a description, bytes.
const MAX_DESCRIPTION_BYTES: u64 = 64 << 20;

/// A range of numbers in a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Section {
    /// Offset of its first byte.
    pub first: u64,
    /// How many 32-bit numbers it has.
    pub count: u64,
}

/// Writes a part.
pub struct PartWriter {
    file: PathBuf,
    out: BufWriter<AtomicFile>,
    hash: Sha256,
    written: u64,
}

impl PartWriter {
    /// Creates a part file, whose sections are appended next.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn create(file: &Path) -> Result<Self, ProjectError> {
        let error = |source| ProjectError::Write { file: file.to_owned(), source };
        let out = BufWriter::new(AtomicFile::create(file).map_err(error)?);
        let mut new = Self { file: file.to_owned(), out, hash: Sha256::new(), written: 0 };
        new.write_hashed(MAGIC)?;
        Ok(new)
    }

    fn write_hashed(&mut self, bytes: &[u8]) -> Result<(), ProjectError> {
        self.hash.update(bytes);
        self.written += bytes.len() as u64;
        self.out.write_all(bytes).map_err(|source| ProjectError::Write { file: self.file.clone(), source })
    }

    /// Appends 32-bit floats; returns the section that they make up.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_floats(&mut self, numbers: impl IntoIterator<Item = f32>) -> Result<Section, ProjectError> {
        self.write_words(numbers.into_iter().map(f32::to_bits))
    }

    /// Appends 32-bit integers; returns the section that they make up.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_words(&mut self, numbers: impl IntoIterator<Item = u32>) -> Result<Section, ProjectError> {
        const BATCH_BYTES: usize = 1 << 16;
        let first = self.written;
        let mut bytes = Vec::with_capacity(BATCH_BYTES);
        for number in numbers {
            bytes.extend(number.to_le_bytes());
            if bytes.len() == BATCH_BYTES {
                self.write_hashed(&bytes)?;
                bytes.clear();
            }
        }
        self.write_hashed(&bytes)?;
        Ok(Section { first, count: (self.written - first) / 4 })
    }

    /// Completes the part file with its description and its seal.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(mut self, description: &Value) -> Result<(), ProjectError> {
        let text = description.to_string();
        self.write_hashed(text.as_bytes())?;
        self.write_hashed(&(text.len() as u64).to_le_bytes())?;
        let seal = self.hash.clone().finalize();
        self.write_hashed(&seal)?;
        let Self { file, out, .. } = self;
        let error = |source| ProjectError::Write { file: file.clone(), source };
        let out = out.into_inner().map_err(|failed| error(failed.into_error()))?;
        out.commit().map_err(error)
    }
}

/// The version of a part that begins with these bytes, if it has one.
fn version_of(start: &[u8]) -> Option<u64> {
    let digits = start.strip_prefix(MAGIC_OF_ANY_VERSION)?.split(|byte| *byte == b'\n').next()?;
    std::str::from_utf8(digits).ok()?.parse().ok()
}

/// A complete part.
#[derive(Clone, Debug)]
pub struct PartFile {
    /// Its path.
    pub file: PathBuf,
    /// The description of its sections.
    pub description: Value,
}

impl PartFile {
    /// Opens a part file, reading all of it once to verify its seal.
    ///
    /// # Errors
    /// It cannot be read, is not a part, or is incomplete.
    pub fn open(file: &Path) -> Result<Self, ProjectError> {
        let error = |source| ProjectError::Read { file: file.to_owned(), source };
        let damaged = || {
            let problem = "is cut short or damaged";
            ProjectError::content(file, problem, "render its tile again, or take another copy")
        };
        let mut from = File::open(file).map_err(error)?;
        let length = from.metadata().map_err(error)?.len();
        let mut magic = vec![0; MAGIC.len().min(length as usize)];
        from.read_exact(&mut magic).map_err(error)?;
        if let Some(version) = version_of(&magic).filter(|version| *version > VERSION) {
            return Err(ProjectError::Newer { file: file.to_owned(), version, newest: VERSION });
        }
        if !MAGIC.starts_with(&magic) || magic.is_empty() {
            let problem = "is no part of a picture";
            return Err(ProjectError::content(
                file,
                problem,
                "give a file written by render --tiles --shard",
            ));
        }
        let sealed =
            length.checked_sub(32).filter(|sealed| *sealed >= MAGIC.len() as u64 + 8).ok_or_else(damaged)?;
        from.seek(SeekFrom::Start(0)).map_err(error)?;
        let mut hash = Sha256::new();
        let mut rest = BufReader::with_capacity(1 << 20, from.take(sealed));
        std::io::copy(&mut rest, &mut HashWriter(&mut hash)).map_err(error)?;
        let mut from = rest.into_inner().into_inner();
        let mut seal = [0; 32];
        from.seek(SeekFrom::Start(sealed)).and_then(|_| from.read_exact(&mut seal)).map_err(error)?;
        if hash.finalize()[..] != seal {
            return Err(damaged());
        }
        let mut text_length = [0; 8];
        let end = length - END;
        from.seek(SeekFrom::Start(end)).and_then(|_| from.read_exact(&mut text_length)).map_err(error)?;
        let text_length = u64::from_le_bytes(text_length);
        let first = end
            .checked_sub(text_length)
            .filter(|_| text_length <= MAX_DESCRIPTION_BYTES)
            .ok_or_else(damaged)?;
        let mut text = vec![0; text_length as usize];
        from.seek(SeekFrom::Start(first)).and_then(|_| from.read_exact(&mut text)).map_err(error)?;
        let description = serde_json::from_slice(&text).map_err(|_| damaged())?;
        Ok(Self { file: file.to_owned(), description })
    }

    /// Starts to read a section from its beginning.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(&self, section: Section) -> Result<NumberReader, ProjectError> {
        let error = |source| ProjectError::Read { file: self.file.clone(), source };
        let mut from = File::open(&self.file).map_err(error)?;
        from.seek(SeekFrom::Start(section.first)).map_err(error)?;
        let from = BufReader::with_capacity(1 << 16, from.take(section.count.saturating_mul(4)));
        Ok(NumberReader { file: self.file.clone(), from, bytes: Vec::new() })
    }
}

/// Reads the numbers of a section in order.
pub struct NumberReader {
    file: PathBuf,
    from: BufReader<std::io::Take<File>>,
    bytes: Vec<u8>,
}

impl NumberReader {
    /// The next `count` integers of the section.
    ///
    /// # Errors
    /// There are fewer, or the file cannot be read.
    pub fn read_words(&mut self, count: usize) -> Result<Vec<u32>, ProjectError> {
        self.bytes.resize(4 * count, 0);
        self.from
            .read_exact(&mut self.bytes)
            .map_err(|source| ProjectError::Read { file: self.file.clone(), source })?;
        let (words, _) = self.bytes.as_chunks::<4>();
        Ok(words.iter().map(|word| u32::from_le_bytes(*word)).collect())
    }

    /// The next `count` floats of the section.
    ///
    /// # Errors
    /// There are fewer, or the file cannot be read.
    pub fn read_floats(&mut self, count: usize) -> Result<Vec<f32>, ProjectError> {
        Ok(self.read_words(count)?.into_iter().map(f32::from_bits).collect())
    }
}

struct HashWriter<'a>(&'a mut Sha256);

impl Write for HashWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_part_is_read_as_it_was_written_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.part");
        let mut part = PartWriter::create(&file).unwrap();
        let floats = part.write_floats((0..70_000).map(|k| k as f32 * 0.5)).unwrap();
        let words = part.write_words([7, u32::MAX, 0]).unwrap();
        assert!(!file.exists(), "it is not yet whole");
        part.finish(&json!({ "tile": 3 })).unwrap();
        let read = PartFile::open(&file).unwrap();
        assert_eq!(read.description, json!({ "tile": 3 }));
        let mut numbers = read.read(floats).unwrap();
        assert_eq!(numbers.read_floats(3).unwrap(), [0.0, 0.5, 1.0]);
        assert_eq!(numbers.read_floats(69_997).unwrap()[69_996], 69_999.0 * 0.5);
        assert!(numbers.read_words(1).is_err(), "it has no more");
        assert_eq!(read.read(words).unwrap().read_words(3).unwrap(), [7, u32::MAX, 0]);
        let whole = std::fs::read(&file).unwrap();
        for length in [0, 3, 40, whole.len() / 2, whole.len() - 1] {
            std::fs::write(&file, &whole[..length]).unwrap();
            assert!(PartFile::open(&file).is_err(), "{length}");
        }
        for at in [MAGIC.len() + 5, whole.len() - 50, whole.len() - 33, whole.len() - 1] {
            let mut flipped = whole.clone();
            flipped[at] ^= 1;
            std::fs::write(&file, &flipped).unwrap();
            let error = PartFile::open(&file).unwrap_err().to_string();
            assert!(error.contains("cut short or damaged"), "{at}: {error}");
        }
        std::fs::write(&file, b"focus-brush part 12\nof a later program").unwrap();
        assert!(
            PartFile::open(&file).unwrap_err().to_string().contains("version 12, this program reads up to 1")
        );
        std::fs::write(&file, b"something else").unwrap();
        assert!(PartFile::open(&file).unwrap_err().to_string().contains("no part of a picture"));
    }
}
