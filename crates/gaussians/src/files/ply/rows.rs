//! The tables of a PLY file, row by row.

use super::super::reading::Reading;
use super::header::{DataType, Element, Encoding, Header, Scalar};
use crate::error::GaussianError;
use std::io::{BufRead, Read};

/// The file after its header.
pub(super) struct Rows<R> {
    input: R,
    encoding: Encoding,
    /// Bytes read so far, and those of the file.
    at: u64,
    size: u64,
    /// Lines read so far.
    lines: u64,
    /// A row of a binary file, or a line of one in ASCII.
    row: Vec<u8>,
}

impl<R: BufRead> Rows<R> {
    /// `input` stands at the end of the header; the file has `size` bytes.
    pub fn new(header: &Header, input: R, size: u64) -> Self {
        let Header { encoding, bytes, lines, .. } = *header;
        Self { input, encoding, at: bytes, size, lines, row: Vec::new() }
    }

    fn malformed(&self, reading: &Reading<'_>, what: impl ToString) -> GaussianError {
        let place = match self.encoding {
            Encoding::Ascii => format!("line {}", self.lines),
            _ => format!("byte {}", self.at),
        };
        reading.malformed(place, what)
    }

    /// Checks that the file is long enough for the rows that an element, which comes next, declares.
    ///
    /// # Errors
    /// It is too short.
    pub fn check_count(&self, reading: &Reading<'_>, element: &Element) -> Result<(), GaussianError> {
        // The last number of a file in ASCII needs no separator after it.
        let left = self.size.saturating_sub(self.at) + u64::from(self.encoding == Encoding::Ascii);
        match element.count.checked_mul(element.least_bytes(self.encoding)) {
            Some(bytes) if bytes <= left => Ok(()),
            _ => {
                let what = format!(
                    "{} rows of {} do not fit the {left} bytes that are left",
                    element.count, element.name
                );
                Err(self.malformed(reading, what))
            }
        }
    }

    /// Skips the rows of an element.
    ///
    /// # Errors
    /// The file ends before, or is malformed.
    pub fn skip(&mut self, reading: &Reading<'_>, element: &Element) -> Result<(), GaussianError> {
        self.check_count(reading, element)?;
        if element.properties.is_empty() {
            return Ok(());
        }
        let mut values = Vec::new();
        for row in 0..element.count {
            reading.at_row(row, element.count)?;
            self.next(reading, element, &mut values)?;
        }
        Ok(())
    }

    /// Reads the numbers of the next row of an element into `values`: one for each property, NaN for lists, which are skipped.
    ///
    /// # Errors
    /// The file ends before, or is malformed.
    pub fn next(
        &mut self,
        reading: &Reading<'_>,
        element: &Element,
        values: &mut Vec<f64>,
    ) -> Result<(), GaussianError> {
        values.clear();
        match self.encoding {
            Encoding::Ascii => self.next_line(reading, element, values),
            _ if element.is_fixed() => {
                self.fill(reading, element.least_bytes(self.encoding))?;
                let mut rest = &self.row[..];
                for property in &element.properties {
                    let DataType::Scalar(scalar) = property.data_type else { continue };
                    let (bytes, after) = rest.split_at(scalar.size());
                    values.push(decode(scalar, self.encoding, bytes));
                    rest = after;
                }
                Ok(())
            }
            _ => {
                for property in &element.properties {
                    values.push(match property.data_type {
                        DataType::Scalar(scalar) => self.scalar(reading, scalar)?,
                        DataType::List { count, item } => {
                            let count = self.scalar(reading, count)?;
                            let left = self.size.saturating_sub(self.at);
                            if !(count >= 0.0 && count * item.size() as f64 <= left as f64) {
                                let what =
                                    format!("a list of {count} does not fit the {left} bytes that are left");
                                return Err(self.malformed(reading, what));
                            }
                            self.fill(reading, count as u64 * item.size() as u64)?;
                            f64::NAN
                        }
                    });
                }
                Ok(())
            }
        }
    }

    fn scalar(&mut self, reading: &Reading<'_>, scalar: Scalar) -> Result<f64, GaussianError> {
        self.fill(reading, scalar.size() as u64)?;
        Ok(decode(scalar, self.encoding, &self.row))
    }

    /// Reads the next bytes into `self.row`.
    fn fill(&mut self, reading: &Reading<'_>, count: u64) -> Result<(), GaussianError> {
        self.row.clear();
        let read = self.input.by_ref().take(count).read_to_end(&mut self.row);
        self.at += read.map_err(|e| GaussianError::unreadable(reading.file(), e))? as u64;
        if (self.row.len() as u64) < count {
            return Err(self.malformed(reading, "the file ends before its last row"));
        }
        Ok(())
    }

    fn next_line(
        &mut self,
        reading: &Reading<'_>,
        element: &Element,
        values: &mut Vec<f64>,
    ) -> Result<(), GaussianError> {
        /// A row of all properties that a header may have, each of 30 characters.
        const MAX_LINE_BYTES: u64 = 30_000;
        self.row.clear();
        let read = self.input.by_ref().take(MAX_LINE_BYTES).read_until(b'\n', &mut self.row);
        self.at += read.map_err(|e| GaussianError::unreadable(reading.file(), e))? as u64;
        self.lines += 1;
        let line = String::from_utf8_lossy(&self.row);
        let mut fields = line.split_ascii_whitespace();
        for property in &element.properties {
            let number = fields.next().and_then(|field| field.parse::<f64>().ok());
            let Some(number) = number else {
                let what = format!("has no number for {}", property.name);
                return Err(self.malformed(reading, what));
            };
            values.push(match property.data_type {
                DataType::Scalar(_) => number,
                DataType::List { .. } => {
                    fields.by_ref().take(number.max(0.0) as usize).for_each(drop);
                    f64::NAN
                }
            });
        }
        Ok(())
    }
}

/// The number that exactly `scalar.size()` bytes hold.
fn decode(scalar: Scalar, encoding: Encoding, bytes: &[u8]) -> f64 {
    let mut padded = [0; 8];
    padded[..bytes.len()].copy_from_slice(bytes);
    if encoding == Encoding::BigEndian {
        padded[..bytes.len()].reverse();
    }
    let bits = u64::from_le_bytes(padded);
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
