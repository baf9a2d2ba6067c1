//! A picture of attributes.

use super::super::reading::Reading;
use super::container::Container;
use crate::error::{GaussianError, quoted};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::io::Cursor;

/// Texels beyond those that a count needs: pictures are rounded up to whole rows and blocks.
const SPARE_TEXELS: u64 = 1 << 16;

/// Splats for each byte of a picture's file: real attributes take more than a bit.
const MAX_SPLATS_PER_BYTE: u64 = 64;

/// Pixels in the order of splats.
pub(super) struct Texture {
    pub width: u32,
    pub height: u32,
    rgba: Vec<u8>,
}

impl Texture {
    /// Reads the picture `name`, which has a pixel for each of `count` splats.
    ///
    /// # Errors
    /// It is missing, no lossless WebP or PNG, too small, or larger than the count needs.
    pub fn read(
        reading: &Reading<'_>,
        container: &mut Container<'_>,
        name: &str,
        count: u64,
    ) -> Result<Self, GaussianError> {
        let max_texels = count.saturating_mul(2).saturating_add(SPARE_TEXELS);
        let texture = Self::read_sized(reading, container, name, max_texels, count / MAX_SPLATS_PER_BYTE)?;
        let texels = u64::from(texture.width) * u64::from(texture.height);
        if texels < count {
            let what = format!("has {texels} pixels for {count} splats");
            return Err(reading.malformed(quoted(name), what));
        }
        Ok(texture)
    }

    /// Reads the picture `name` of at most `max_texels`, whose file must have at least `min_bytes`.
    ///
    /// # Errors
    /// It is missing, no lossless WebP or PNG, or larger.
    pub fn read_sized(
        reading: &Reading<'_>,
        container: &mut Container<'_>,
        name: &str,
        max_texels: u64,
        min_bytes: u64,
    ) -> Result<Self, GaussianError> {
        /// What a file has beside its pixels.
        const SPARE_BYTES: u64 = 1 << 16;
        let malformed = |what: &str| reading.malformed(quoted(name), what);
        let max_bytes = max_texels.saturating_mul(4);
        reading.check_memory("a picture of its attributes takes", max_bytes)?;
        let bytes = container.read(reading, name, max_bytes.saturating_add(SPARE_BYTES))?;
        if (bytes.len() as u64) < min_bytes {
            return Err(malformed(&format!("has only {} bytes, fewer than its splats need", bytes.len())));
        }
        let format = image::guess_format(&bytes).ok();
        if !matches!(format, Some(ImageFormat::WebP | ImageFormat::Png)) || bytes.get(12..16) == Some(b"VP8 ")
        {
            return Err(malformed("is no lossless WebP or PNG picture"));
        }
        let undecodable = |e: image::ImageError| malformed(&format!("cannot be decoded: {e}"));
        let mut limits = Limits::default();
        limits.max_alloc = Some(max_bytes.saturating_mul(2).saturating_add(SPARE_BYTES));
        let mut reader = ImageReader::new(Cursor::new(&bytes));
        reader.set_format(format.unwrap_or(ImageFormat::WebP));
        reader.limits(limits);
        let decoder = reader.into_decoder().map_err(undecodable)?;
        let (width, height) = decoder.dimensions();
        if u64::from(width) * u64::from(height) > max_texels {
            return Err(malformed(&format!("has {width} × {height} pixels, more than its splats need")));
        }
        let rgba = DynamicImage::from_decoder(decoder).map_err(undecodable)?.into_rgba8().into_raw();
        Ok(Self { width, height, rgba })
    }

    /// The bytes that it takes.
    pub fn bytes(&self) -> u64 {
        self.rgba.len() as u64
    }

    /// Red, green, blue and alpha of a pixel, counted row by row from the top.
    pub fn pixel(&self, index: usize) -> [u8; 4] {
        [0, 1, 2, 3].map(|channel| self.rgba[4 * index + channel])
    }
}
