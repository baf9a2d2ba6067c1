//! The header of a PLY file.

use crate::CaptureError;
use crate::files::text::quoted;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// The elements in the order of the file.
#[derive(Debug)]
pub(super) struct Header {
    /// The encoding of the body.
    pub format: Format,
    pub elements: Vec<Element>,
}

/// The file after the header.
#[derive(Debug)]
pub(super) struct Rest {
    pub input: BufReader<File>,
    /// Lines of the header.
    pub lines: usize,
    /// Bytes of the header.
    pub at: u64,
    /// Bytes of the file.
    pub size: u64,
}

/// A table of the file.
#[derive(Debug)]
pub(super) struct Element {
    pub name: String,
    /// Rows.
    pub count: u64,
    /// Columns.
    pub properties: Vec<Property>,
}

#[derive(Debug)]
pub(super) struct Property {
    pub name: String,
    pub data_type: DataType,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum DataType {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// How the body is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

impl Scalar {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// The number of bytes in a binary file.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

impl DataType {
    /// The number that stands for full intensity in a colour of this type.
    pub fn white(self) -> f64 {
        match self {
            Self::Scalar(Scalar::F32 | Scalar::F64) | Self::List { .. } => 1.0,
            Self::Scalar(integer) => (1u64 << (8 * integer.size())) as f64 - 1.0,
        }
    }
}

impl Element {
    /// The least number of bytes that a row takes in this format.
    pub fn least_bytes(&self, format: Format) -> u64 {
        let min_size = |property: &Property| match (format, property.data_type) {
            // A digit and a separator.
            (Format::Ascii, _) => 2,
            (_, DataType::Scalar(scalar)) => scalar.size() as u64,
            (_, DataType::List { count, .. }) => count.size() as u64,
        };
        self.properties.iter().map(min_size).sum()
    }
}

impl Header {
    /// Reads the header of a file; returns it with the rest of the file.
    ///
    /// # Errors
    /// The file cannot be read, or is no PLY.
    pub fn open(file: &Path) -> Result<(Self, Rest), CaptureError> {
        let unreadable = |source| CaptureError::unreadable(file, source);
        let mut input = BufReader::new(File::open(file).map_err(unreadable)?);
        let size = input.get_ref().metadata().map_err(unreadable)?.len();
        let mut elements: Vec<Element> = Vec::new();
        let mut format = None;
        let mut at = 0;
        /// More lines are no header.
        const MOST_LINES: usize = 1000;
        for number in 1..=MOST_LINES {
            const LONGEST: u64 = 4096;
            let mut line = Vec::new();
            at += (&mut input).take(LONGEST).read_until(b'\n', &mut line).map_err(unreadable)? as u64;
            let line = String::from_utf8_lossy(&line);
            let fields: Vec<&str> = line.split_whitespace().collect();
            let wrong = |what: &str| CaptureError::malformed(file, format!("line {number}"), what);
            match fields[..] {
                ["ply"] if number == 1 => {}
                _ if number == 1 => return Err(wrong("is not a PLY file: it does not begin with ply")),
                ["format", name, _] => {
                    format = Some(match name {
                        "ascii" => Format::Ascii,
                        "binary_little_endian" => Format::LittleEndian,
                        "binary_big_endian" => Format::BigEndian,
                        _ => return Err(wrong(&format!("the format {} is not supported", quoted(name)))),
                    });
                }
                ["element", name, count] => {
                    let count =
                        count.parse().map_err(|_| wrong(&format!("{} is not a count", quoted(count))))?;
                    elements.push(Element { name: name.into(), count, properties: Vec::new() });
                }
                ["property", .., name] => {
                    let data_type = match fields[1..fields.len() - 1] {
                        ["list", count, item] => Scalar::named(count)
                            .zip(Scalar::named(item))
                            .map(|(count, item)| DataType::List { count, item }),
                        [scalar] => Scalar::named(scalar).map(DataType::Scalar),
                        _ => None,
                    };
                    let data_type = data_type.ok_or_else(|| wrong("is not a property of a known type"))?;
                    let element =
                        elements.last_mut().ok_or_else(|| wrong("is a property without an element"))?;
                    element.properties.push(Property { name: name.into(), data_type });
                }
                ["end_header"] => {
                    let format = format.ok_or_else(|| wrong("no format is specified"))?;
                    return Ok((Self { format, elements }, Rest { input, lines: number, at, size }));
                }
                ["comment" | "obj_info", ..] | [] => {}
                _ => return Err(wrong(&format!("{} is not a header line", quoted(line.trim())))),
            }
        }
        Err(CaptureError::malformed(file, format!("line {MOST_LINES}"), "the header does not end"))
    }

    /// The element with this name; `None` if there is none.
    pub fn element(&self, name: &str) -> Option<&Element> {
        self.elements.iter().find(|element| element.name == name)
    }

    /// The elements up to the last of these names, and whether each is the first of one of them.
    pub fn until(&self, names: &[&str]) -> Vec<(&Element, bool)> {
        let first = |name: &&str| self.elements.iter().position(|element| element.name == **name);
        let indices: Vec<usize> = names.iter().filter_map(first).collect();
        let end = indices.iter().max().map_or(0, |last| last + 1);
        self.elements[..end]
            .iter()
            .enumerate()
            .map(|(index, element)| (element, indices.contains(&index)))
            .collect()
    }
}
