//! The header of a Radiance picture.

use std::io::{BufRead, Read};

/// Maximum length of a header, which may list all commands that made the picture.
const MAX_BYTES: u64 = 1 << 20;

/// How the picture's scanlines lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Header {
    /// Number of scanlines, ≥ 1.
    pub scanlines: u32,
    /// Number of pixels of each, ≥ 1.
    pub length: u32,
    /// Whether scanlines are columns.
    by_columns: bool,
    /// Whether x falls, and whether y falls (which goes up): from the one end of the picture to the other.
    falls: [bool; 2],
}

impl Header {
    /// Reads a header to its end; what is wrong with its content is text.
    ///
    /// # Errors
    /// The input cannot be read.
    pub fn read(input: &mut impl BufRead) -> std::io::Result<Result<Self, String>> {
        let mut input = input.take(MAX_BYTES);
        let mut is_end = false;
        loop {
            let mut bytes = Vec::new();
            input.read_until(b'\n', &mut bytes)?;
            if bytes.pop() != Some(b'\n') {
                let is_longer = input.limit() == 0;
                let what =
                    if is_longer { "its header is longer than 1 MiB" } else { "it ends within its header" };
                return Ok(Err(what.into()));
            }
            let line = String::from_utf8_lossy(&bytes);
            let line = line.trim();
            // Some programs omit the empty line.
            if is_end || ["+Y", "-Y", "+X", "-X"].iter().any(|axis| line.starts_with(axis)) {
                return Ok(Self::from_axes(line));
            }
            is_end = line.is_empty();
            if let Some(("FORMAT", format)) =
                line.split_once('=').map(|(name, value)| (name.trim(), value.trim()))
            {
                match format {
                    "32-bit_rle_rgbe" => {}
                    "32-bit_rle_xyze" => {
                        let what = "its colours are CIE XYZ; convert them to RGB with Radiance: ra_xyze -r";
                        return Ok(Err(what.into()));
                    }
                    _ => return Ok(Err(format!("it has FORMAT={format}, not 32-bit_rle_rgbe"))),
                }
            }
        }
    }

    /// From a line like `-Y 512 +X 1024`.
    fn from_axes(line: &str) -> Result<Self, String> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let count =
            |word: &str| word.parse::<u32>().ok().filter(|count| (1..=i32::MAX as u32).contains(count));
        let axes = match words[..] {
            [major, scanlines, minor, length] => Some((major, count(scanlines), minor, count(length))),
            _ => None,
        };
        let Some((major, Some(scanlines), minor, Some(length))) = axes else {
            return Err(format!("its size is given as '{line}', not like '-Y 512 +X 1024'"));
        };
        let (by_columns, x, y) = match [major, minor] {
            ["+Y" | "-Y", "+X" | "-X"] => (false, minor, major),
            ["+X" | "-X", "+Y" | "-Y"] => (true, major, minor),
            _ => return Err(format!("its size is given as '{line}', not like '-Y 512 +X 1024'")),
        };
        let falls = [x, y].map(|axis| axis.starts_with('-'));
        Ok(Self { scanlines, length, by_columns, falls })
    }

    /// Columns and rows of the picture, px.
    pub fn size(&self) -> [u32; 2] {
        if self.by_columns { [self.scanlines, self.length] } else { [self.length, self.scanlines] }
    }

    /// Column and row, from the upper left, of pixel `at` of a scanline.
    pub fn place(&self, scanline: usize, at: usize) -> [usize; 2] {
        let [width, height] = self.size().map(|side| side as usize);
        let [x, y] = if self.by_columns { [scanline, at] } else { [at, scanline] };
        let [x_falls, y_falls] = self.falls;
        [if x_falls { width - 1 - x } else { x }, if y_falls { y } else { height - 1 - y }]
    }
}
