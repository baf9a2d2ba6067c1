//! Text files by lines, with their numbers: shared by COLMAP, Bundler, VisualSFM, PLY and OBJ.

use crate::CaptureError;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// The lines of a file, one at a time.
pub(crate) struct Lines {
    pub file: PathBuf,
    input: BufReader<File>,
    line: Vec<u8>,
    /// The number of the current line, from 1.
    pub number: usize,
}

/// The longest line of text. A line of COLMAP holds all points of a picture.
const LONGEST: u64 = 64 << 20;

impl Lines {
    /// Opens a file of lines before its first.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn open(file: &Path) -> Result<Self, CaptureError> {
        let input = File::open(file).map_err(|source| CaptureError::unreadable(file, source))?;
        Ok(Self { file: file.into(), input: BufReader::new(input), line: Vec::new(), number: 0 })
    }

    /// The remaining lines of an opened file, after `number` lines.
    pub fn rest_of(file: &Path, input: BufReader<File>, number: usize) -> Self {
        Self { file: file.into(), input, line: Vec::new(), number }
    }

    /// The next line, trimmed; `None` at the end. Bytes that are not UTF-8 are replaced.
    ///
    /// # Errors
    /// The file cannot be read, or a line is too long.
    pub fn next(&mut self) -> Result<Option<String>, CaptureError> {
        Ok(self.advance()?.then(|| {
            let text = String::from_utf8_lossy(&self.line);
            text.trim_start_matches('\u{feff}').trim().to_owned()
        }))
    }

    /// The next line that is neither empty nor a comment (`#`), trimmed; `None` at the end.
    ///
    /// # Errors
    /// As [`Self::next`].
    pub fn next_filled(&mut self) -> Result<Option<String>, CaptureError> {
        while let Some(line) = self.next()? {
            if !line.is_empty() && !line.starts_with('#') {
                return Ok(Some(line));
            }
        }
        Ok(None)
    }

    fn advance(&mut self) -> Result<bool, CaptureError> {
        self.line.clear();
        let mut limited = (&mut self.input).take(LONGEST);
        let read = limited.read_until(b'\n', &mut self.line);
        let read = read.map_err(|source| CaptureError::unreadable(&self.file, source))?;
        self.number += 1;
        if read as u64 == LONGEST {
            return Err(self.malformed("is too long to be a line of text"));
        }
        Ok(read > 0)
    }

    /// An error that says what is wrong in the current line.
    pub fn malformed(&self, what: impl ToString) -> CaptureError {
        CaptureError::malformed(&self.file, format!("line {}", self.number), what)
    }
}

/// A finite number, optionally with a decimal comma, or with a comma after it.
pub(crate) fn number(field: &str) -> Option<f64> {
    let field = field.strip_suffix(',').unwrap_or(field);
    let value = match field.parse::<f64>() {
        Ok(value) => value,
        Err(_) if field.matches(',').count() == 1 && !field.contains('.') => {
            field.replace(',', ".").parse().ok()?
        }
        Err(_) => return None,
    };
    value.is_finite().then_some(value)
}

/// N numbers.
pub(crate) fn numbers<const N: usize>(fields: &[&str]) -> Option<[f64; N]> {
    let mut values = [0.0; N];
    (fields.len() == N).then_some(())?;
    for (value, field) in values.iter_mut().zip(fields) {
        *value = number(field)?;
    }
    Some(values)
}

/// A non-negative integer.
pub(crate) fn count(field: &str) -> Option<u64> {
    field.strip_suffix(',').unwrap_or(field).parse().ok()
}

/// A piece of a file for a message: short, and on one line.
pub(crate) fn quoted(text: &str) -> String {
    let mut short: String = text.chars().take(40).map(|c| if c.is_control() { '?' } else { c }).collect();
    if text.chars().nth(40).is_some() {
        short.push('…');
    }
    format!("{short:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_as_they_are_written() {
        for (field, value) in
            [("1.5", 1.5), ("-1,5", -1.5), ("1e-3", 1e-3), ("3,", 3.0), ("1.5,", 1.5), ("0,851773", 0.851773)]
        {
            assert_eq!(number(field), Some(value), "{field}");
        }
        for field in ["", "a", "nan", "inf", "1,2,3", "1.2,3", "1e999"] {
            assert_eq!(number(field), None, "{field}");
        }
        assert_eq!(numbers(&["1", "2"]), Some([1.0, 2.0]));
        assert_eq!(numbers::<3>(&["1", "2"]), None);
    }

    #[test]
    fn lines_have_numbers() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.txt");
        std::fs::write(&file, "\u{feff}# head\r\n\r\n  one  \n# two\nthree").unwrap();
        let mut lines = Lines::open(&file).unwrap();
        assert_eq!((lines.next_filled().unwrap().as_deref(), lines.number), (Some("one"), 3));
        assert_eq!((lines.next_filled().unwrap().as_deref(), lines.number), (Some("three"), 5));
        assert_eq!(lines.next_filled().unwrap(), None);
    }

    #[test]
    fn quotes_are_short() {
        assert_eq!(quoted("a\nb"), "\"a?b\"");
        assert!(quoted(&"x".repeat(1000)).len() < 60);
    }
}
