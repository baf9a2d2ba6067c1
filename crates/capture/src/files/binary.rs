//! Little-endian binary files, read from front to back; every count is checked against the rest of the file.

use crate::CaptureError;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// A binary file.
pub(crate) struct Binary {
    pub file: PathBuf,
    input: BufReader<File>,
    /// Bytes read so far.
    at: u64,
    size: u64,
}

impl Binary {
    /// Opens a file at its beginning.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn open(file: &Path) -> Result<Self, CaptureError> {
        let unreadable = |source| CaptureError::unreadable(file, source);
        let input = File::open(file).map_err(unreadable)?;
        let size = input.metadata().map_err(unreadable)?.len();
        Ok(Self { file: file.into(), input: BufReader::new(input), at: 0, size })
    }

    /// The next N bytes; `what` names them in errors, here and below.
    ///
    /// # Errors
    /// The file cannot be read or ends before.
    pub fn bytes<const N: usize>(&mut self, what: &str) -> Result<[u8; N], CaptureError> {
        let mut bytes = [0; N];
        match self.input.read_exact(&mut bytes) {
            Ok(()) => {
                self.at += N as u64;
                Ok(bytes)
            }
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
                Err(self.malformed(format!("the file ends within {what}")))
            }
            Err(source) => Err(CaptureError::unreadable(&self.file, source)),
        }
    }

    /// The next 4 bytes as a number, little endian.
    ///
    /// # Errors
    /// As [`Self::bytes`].
    pub fn u32(&mut self, what: &str) -> Result<u32, CaptureError> {
        self.bytes(what).map(u32::from_le_bytes)
    }

    /// The next 8 bytes as a number, little endian.
    ///
    /// # Errors
    /// As [`Self::bytes`].
    pub fn u64(&mut self, what: &str) -> Result<u64, CaptureError> {
        self.bytes(what).map(u64::from_le_bytes)
    }

    /// The next 8 bytes as a finite number, little endian.
    ///
    /// # Errors
    /// As [`Self::bytes`], or the number is not finite.
    pub fn f64(&mut self, what: &str) -> Result<f64, CaptureError> {
        let at = self.at;
        let value = self.bytes(what).map(f64::from_le_bytes)?;
        match value.is_finite() {
            true => Ok(value),
            false => Err(self.malformed_at(at, format!("{what} is {value}"))),
        }
    }

    /// The next N finite numbers of 8 bytes.
    ///
    /// # Errors
    /// As [`Self::f64`].
    pub fn f64s<const N: usize>(&mut self, what: &str) -> Result<[f64; N], CaptureError> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.f64(what)?;
        }
        Ok(values)
    }

    /// A count (8 bytes) of items of at least `each` bytes that follow.
    ///
    /// # Errors
    /// As [`Self::bytes`], or the rest of the file is too short for them.
    pub fn count(&mut self, each: u64, what: &str) -> Result<u64, CaptureError> {
        let at = self.at;
        let count = self.u64(what)?;
        let left = self.size.saturating_sub(self.at);
        match count.checked_mul(each) {
            Some(bytes) if bytes <= left => Ok(count),
            _ => {
                Err(self.malformed_at(at, format!("declares {count} {what}, but only {left} bytes are left")))
            }
        }
    }

    /// A zero-terminated text; `what` names it in errors.
    ///
    /// # Errors
    /// The file cannot be read, or the text is too long or does not end.
    pub fn text(&mut self, what: &str) -> Result<String, CaptureError> {
        /// The longest path of any system, twice.
        const LONGEST: u64 = 1 << 16;
        let at = self.at;
        let mut bytes = Vec::new();
        let read = (&mut self.input).take(LONGEST).read_until(0, &mut bytes);
        self.at += read.map_err(|source| CaptureError::unreadable(&self.file, source))? as u64;
        match bytes.pop() {
            Some(0) => Ok(String::from_utf8_lossy(&bytes).into_owned()),
            _ => Err(self.malformed_at(at, format!("{what} does not end"))),
        }
    }

    /// Skips this many bytes.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn skip(&mut self, bytes: u64) -> Result<(), CaptureError> {
        self.at += bytes;
        let skipped = self.input.seek_relative(bytes as i64);
        skipped.map_err(|source| CaptureError::unreadable(&self.file, source))
    }

    /// An error that says what is wrong at the current byte.
    pub fn malformed(&self, what: impl ToString) -> CaptureError {
        self.malformed_at(self.at, what)
    }

    fn malformed_at(&self, at: u64, what: impl ToString) -> CaptureError {
        CaptureError::malformed(&self.file, format!("byte {at}"), what)
    }
}
