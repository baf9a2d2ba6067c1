//! A PNG row by row: for a mosaic of forty megapixels only one row is kept.

use crate::files::whole_file::head;
use png::{BitDepth, ColorType, Decoder, Limits, Transformations};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// A PNG's header, and its rows.
pub(super) struct PngRows {
    reader: png::Reader<BufReader<File>>,
    pub size: [u32; 2],
    /// Channels of a pixel: 1 grey, 2 with alpha, 3 colours, 4 with alpha.
    pub channels: usize,
    /// Whether channels have two bytes.
    pub is_deep: bool,
    pub profile: Option<Vec<u8>>,
}

impl PngRows {
    /// Opens the rows of a file; `None` if it is no PNG, or interlaced. Decoding takes at most a quarter of
    /// `max_memory` bytes.
    ///
    /// # Errors
    /// Why it cannot be decoded, as text.
    pub fn open(file: &Path, max_memory: u64) -> Option<Result<Self, String>> {
        if !head(file, 8).starts_with(b"\x89PNG\r\n\x1a\n") {
            return None;
        }
        let input = BufReader::new(File::open(file).ok()?);
        let limits = Limits { bytes: usize::try_from(max_memory / 4).unwrap_or(usize::MAX) };
        let mut decoder = Decoder::new_with_limits(input, limits);
        decoder.set_transformations(Transformations::EXPAND);
        let reader = match decoder.read_info() {
            Ok(reader) => reader,
            Err(error) => return Some(Err(error.to_string())),
        };
        let info = reader.info();
        if info.interlaced {
            return None;
        }
        let size = [info.width, info.height];
        let profile = info.icc_profile.as_ref().map(|profile| profile.to_vec());
        let (color, depth) = reader.output_color_type();
        let channels = match color {
            ColorType::Grayscale => 1,
            ColorType::GrayscaleAlpha => 2,
            ColorType::Rgb | ColorType::Indexed => 3,
            ColorType::Rgba => 4,
        };
        Some(Ok(Self { reader, size, channels, is_deep: depth == BitDepth::Sixteen, profile }))
    }

    /// The bytes of the next row, samples big endian.
    ///
    /// # Errors
    /// Why it cannot be decoded, as text.
    pub fn next(&mut self) -> Result<&[u8], String> {
        match self.reader.next_row() {
            Ok(Some(row)) => Ok(row.data()),
            Ok(None) => Err("it ends before its last row".into()),
            Err(error) => Err(error.to_string()),
        }
    }

    /// The number of bytes of a pixel.
    pub fn pixel_bytes(&self) -> usize {
        self.channels * if self.is_deep { 2 } else { 1 }
    }
}
