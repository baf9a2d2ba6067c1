//! The header of a PLY file: its encoding and its tables.

use super::super::reading::Reading;
use crate::error::{GaussianError, quoted};
use std::io::{BufRead, Read};

/// What comes before the tables.
pub(super) struct Header {
    pub encoding: Encoding,
    /// The tables, in the order of the file.
    pub elements: Vec<Element>,
    /// Whether a comment says that the splats were trained with a compensated low-pass: `SplatRenderMode: mip` of Brush, `antialiased 1` of
    /// Postshot.
    pub is_antialiased: bool,
    /// Its size.
    pub bytes: u64,
    /// Its lines.
    pub lines: u64,
}

/// How the tables are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A table.
pub(super) struct Element {
    pub name: String,
    /// Rows.
    pub count: u64,
    pub properties: Vec<Property>,
}

/// A column.
pub(super) struct Property {
    pub name: String,
    pub data_type: DataType,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

impl Scalar {
    fn from_name(name: &str) -> Option<Self> {
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

    /// Its bytes in a binary file.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number that stands for full intensity in a colour of this type.
    pub fn white(self) -> f64 {
        match self {
            Self::F32 | Self::F64 => 1.0,
            Self::I8 | Self::U8 => 255.0,
            Self::I16 | Self::U16 => 65535.0,
            Self::I32 | Self::U32 => f64::from(u32::MAX),
        }
    }
}

impl Element {
    /// The place of a column among the properties.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|property| property.name == name)
    }

    /// Whether all columns are single numbers.
    pub fn is_fixed(&self) -> bool {
        self.properties.iter().all(|property| matches!(property.data_type, DataType::Scalar(_)))
    }

    /// The least number of bytes of a row.
    pub fn least_bytes(&self, encoding: Encoding) -> u64 {
        let min_size = |property: &Property| match (encoding, property.data_type) {
            // A digit and a separator.
            (Encoding::Ascii, _) => 2,
            (_, DataType::Scalar(scalar) | DataType::List { count: scalar, .. }) => scalar.size() as u64,
        };
        self.properties.iter().map(min_size).sum()
    }
}

impl Header {
    /// Reads up to `end_header` and its line end.
    ///
    /// # Errors
    /// It cannot be read, or is no header of PLY.
    pub fn read(reading: &Reading<'_>, input: &mut impl BufRead) -> Result<Self, GaussianError> {
        /// Files with more columns than splats have are refused, as are endless lines.
        const MAX_LINES: u64 = 1000;
        const MAX_LINE_BYTES: u64 = 4096;
        let mut encoding = None;
        let mut header = Self {
            encoding: Encoding::Ascii,
            elements: Vec::new(),
            is_antialiased: false,
            bytes: 0,
            lines: 0,
        };
        while header.lines < MAX_LINES {
            header.lines += 1;
            let mut line = Vec::new();
            let length = input.by_ref().take(MAX_LINE_BYTES).read_until(b'\n', &mut line);
            header.bytes += length.map_err(|e| GaussianError::unreadable(reading.file(), e))? as u64;
            let malformed = |what: &str| reading.malformed(format!("line {}", header.lines), what);
            if !line.ends_with(b"\n") {
                return Err(malformed("the header does not end"));
            }
            let line = String::from_utf8_lossy(&line);
            let fields: Vec<&str> = line.split_whitespace().collect();
            match fields[..] {
                ["ply"] if header.lines == 1 => {}
                ["format", name, _] => {
                    encoding = Some(match name {
                        "ascii" => Encoding::Ascii,
                        "binary_little_endian" => Encoding::LittleEndian,
                        "binary_big_endian" => Encoding::BigEndian,
                        _ => return Err(malformed(&format!("the format {} is not PLY's", quoted(name)))),
                    });
                }
                ["element", name, count] => {
                    let count =
                        count.parse().map_err(|_| malformed(&format!("{} is not a count", quoted(count))))?;
                    header.elements.push(Element { name: name.into(), count, properties: Vec::new() });
                }
                ["property", .., name] => {
                    let data_type = match fields[1..fields.len() - 1] {
                        ["list", count, item] => Scalar::from_name(count)
                            .zip(Scalar::from_name(item))
                            .map(|(count, item)| DataType::List { count, item }),
                        [scalar] => Scalar::from_name(scalar).map(DataType::Scalar),
                        _ => None,
                    };
                    let data_type = data_type.ok_or_else(|| malformed("is no property of a type of PLY"))?;
                    let Some(element) = header.elements.last_mut() else {
                        return Err(malformed("is a property without an element"));
                    };
                    element.properties.push(Property { name: name.into(), data_type });
                }
                ["end_header"] => {
                    header.encoding = encoding.ok_or_else(|| malformed("no format is specified"))?;
                    return Ok(header);
                }
                ["comment" | "obj_info", ref words @ ..] => {
                    let words: Vec<String> = words.iter().map(|word| word.to_ascii_lowercase()).collect();
                    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
                        ["splatrendermode:", mode] => header.is_antialiased = mode == "mip",
                        ["antialiased", value] => header.is_antialiased = value == "1",
                        _ => {}
                    }
                }
                [] => {}
                _ => return Err(malformed(&format!("{} is not a line of a header", quoted(line.trim())))),
            }
        }
        Err(reading.malformed(format!("line {MAX_LINES}"), "the header does not end"))
    }

    /// The table of vertices.
    ///
    /// # Errors
    /// There is none.
    pub fn vertices(&self, reading: &Reading<'_>) -> Result<&Element, GaussianError> {
        let vertices = self.elements.iter().find(|element| element.name == "vertex");
        vertices.ok_or_else(|| GaussianError::no_splats(reading.file(), "is a PLY file without vertices"))
    }
}
