//! The tables of a PLY file, row by row.

use super::header::{DataType, Element, Format, Rest, Scalar};
use crate::CaptureError;
use crate::files::text::Lines;
use scene::LoadOptions;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

/// The data after the header.
pub(super) struct Body {
    file: PathBuf,
    input: Input,
    format: Format,
    /// Bytes read so far; for an ASCII file those of the header.
    at: u64,
    size: u64,
}

enum Input {
    Binary(BufReader<File>),
    Ascii { lines: Lines, line: String, next: usize },
}

impl Body {
    /// The body of a file, which `rest` is after the header.
    pub fn new(file: &Path, format: Format, rest: Rest) -> Self {
        let Rest { input, lines, at, size } = rest;
        let input = match format {
            Format::Ascii => {
                Input::Ascii { lines: Lines::rest_of(file, input, lines), line: String::new(), next: 0 }
            }
            _ => Input::Binary(input),
        };
        Self { file: file.into(), input, format, at, size }
    }

    /// An error that says what is wrong at the current line or byte.
    pub fn malformed(&self, what: impl ToString) -> CaptureError {
        let place = match &self.input {
            Input::Binary(_) => format!("byte {}", self.at),
            Input::Ascii { lines, .. } => format!("line {}", lines.number),
        };
        CaptureError::malformed(&self.file, place, what)
    }

    /// Checks that the file is long enough for the rows that an element declares.
    ///
    /// # Errors
    /// It is too short.
    pub fn check_count(&self, element: &Element) -> Result<(), CaptureError> {
        // The last number of a file needs no separator after it.
        let left = self.size.saturating_sub(self.at) + 1;
        match element.count.checked_mul(element.least_bytes(self.format)) {
            Some(bytes) if bytes <= left => Ok(()),
            _ => {
                let (count, name) = (element.count, crate::files::text::quoted(&element.name));
                Err(self
                    .malformed(format!("{count} rows of {name} do not fit the {left} bytes that are left")))
            }
        }
    }

    /// Checks that the rows of an element, of `each` bytes in memory, take no more memory than allowed.
    ///
    /// # Errors
    /// They take more.
    pub fn check_memory(
        &self,
        element: &Element,
        each: u64,
        options: &LoadOptions,
    ) -> Result<(), CaptureError> {
        let bytes = element.count.saturating_mul(each);
        if element.count < u64::from(u32::MAX) && bytes <= options.max_memory {
            return Ok(());
        }
        let what = format!(
            "{} vertices take {} MiB, the limit is {} MiB",
            element.count,
            bytes >> 20,
            options.max_memory >> 20
        );
        Err(CaptureError::TooBig { file: self.file.clone(), what })
    }

    /// Skips the rows of an element.
    ///
    /// # Errors
    /// The file cannot be read, ends before, or is malformed.
    pub fn skip(&mut self, element: &Element) -> Result<(), CaptureError> {
        let is_fixed =
            element.properties.iter().all(|property| matches!(property.data_type, DataType::Scalar(_)));
        if let Input::Binary(input) = &mut self.input
            && is_fixed
        {
            let bytes = element.count * element.least_bytes(self.format);
            self.at += bytes;
            return input
                .seek_relative(bytes as i64)
                .map_err(|source| CaptureError::unreadable(&self.file, source));
        }
        let mut row = vec![0.0; element.properties.len()];
        // Rows without columns take no bytes.
        let rows = if row.is_empty() { 0 } else { element.count };
        for _ in 0..rows {
            self.row(element, &mut row, None)?;
        }
        Ok(())
    }

    /// Reads a row: the numbers of its scalar columns into `row`, and the list of one column, if asked for.
    ///
    /// # Errors
    /// The file cannot be read, ends before, or is malformed.
    pub fn row(
        &mut self,
        element: &Element,
        row: &mut [f64],
        mut list: Option<(usize, &mut Vec<f64>)>,
    ) -> Result<(), CaptureError> {
        for (column, property) in element.properties.iter().enumerate() {
            match property.data_type {
                DataType::Scalar(scalar) => row[column] = self.value(scalar)?,
                DataType::List { count, item } => {
                    let count = self.value(count)?;
                    let left = self.size.saturating_sub(self.at) as f64;
                    if !(count >= 0.0 && count <= left) {
                        return Err(self.malformed(format!("a list of {count} does not fit the file")));
                    }
                    let mut target = list
                        .as_mut()
                        .filter(|(target_column, _)| *target_column == column)
                        .map(|(_, list)| &mut **list);
                    if let Some(list) = &mut target {
                        list.clear();
                    }
                    for _ in 0..count as u64 {
                        let value = self.value(item)?;
                        if let Some(list) = &mut target {
                            list.push(value);
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// The next number. In ASCII files any number; it may be infinite or NaN.
    fn value(&mut self, scalar: Scalar) -> Result<f64, CaptureError> {
        match &mut self.input {
            Input::Binary(input) => {
                let mut bytes = [0; 8];
                let bytes = &mut bytes[..scalar.size()];
                if let Err(error) = input.read_exact(bytes) {
                    return Err(match error.kind() {
                        std::io::ErrorKind::UnexpectedEof => self.malformed("the file ends too early"),
                        _ => CaptureError::unreadable(&self.file, error),
                    });
                }
                self.at += bytes.len() as u64;
                if self.format == Format::BigEndian {
                    bytes.reverse();
                }
                Ok(from_little_endian(scalar, bytes))
            }
            Input::Ascii { lines, line, next } => loop {
                let rest = &line[*next..];
                let start = rest.find(|c: char| !c.is_whitespace());
                let Some(start) = start else {
                    *line = lines.next()?.ok_or_else(|| lines.malformed("the file ends too early"))?;
                    *next = 0;
                    continue;
                };
                let word = &rest[start..];
                let word = &word[..word.find(char::is_whitespace).unwrap_or(word.len())];
                let value = word.parse().or_else(|_| word.replace(',', ".").parse());
                let value = value.map_err(|_| {
                    lines.malformed(format!("{} is not a number", crate::files::text::quoted(word)))
                })?;
                *next += start + word.len();
                return Ok(value);
            },
        }
    }
}

fn from_little_endian(scalar: Scalar, bytes: &[u8]) -> f64 {
    let mut whole = [0; 8];
    whole[..bytes.len()].copy_from_slice(bytes);
    let bits = u64::from_le_bytes(whole);
    match scalar {
        Scalar::I8 => f64::from(bits as u8 as i8),
        Scalar::U8 => f64::from(bits as u8),
        Scalar::I16 => f64::from(bits as u16 as i16),
        Scalar::U16 => f64::from(bits as u16),
        Scalar::I32 => f64::from(bits as u32 as i32),
        Scalar::U32 => f64::from(bits as u32),
        Scalar::F32 => f64::from(f32::from_bits(bits as u32)),
        Scalar::F64 => f64::from_bits(bits),
    }
}
