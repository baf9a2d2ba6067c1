//! A mosaic's file, and views of it.

use super::png_rows::PngRows;
use crate::CaptureError;
use crate::files::picture_header::read_header;
use image::{DynamicImage, ImageBuffer};
use scene::{LoadOptions, Photograph, PictureError};
use std::fmt;
use std::path::{Path, PathBuf};

/// A picture of adjacent micro-images without gaps.
#[derive(Clone, PartialEq, Eq)]
pub struct Mosaic {
    file: PathBuf,
    size: [u32; 2],
    pitch: [u32; 2],
}

impl Mosaic {
    /// Opens a mosaic whose micro-images are of `pitch` pixels across and down, which is the number of columns and rows of views.
    ///
    /// # Errors
    /// The file is no picture, or holds less than two micro-images a side.
    pub fn open(file: &Path, pitch: [u32; 2]) -> Result<Self, CaptureError> {
        let (size, _) = read_header(file).map_err(|why| CaptureError::malformed(file, "picture", why))?;
        let fits = |axis: usize| pitch[axis] > 0 && size[axis] / pitch[axis] >= 2;
        if !(fits(0) && fits(1) && pitch[0].saturating_mul(pitch[1]) > 1) {
            let what = format!(
                "{} × {} px hold no micro-images of {} × {} px",
                size[0], size[1], pitch[0], pitch[1]
            );
            return Err(CaptureError::malformed(file, "pitch", what));
        }
        Ok(Self { file: file.into(), size, pitch })
    }

    /// The picture file that holds the micro-images.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Columns and rows of pixels of a micro-image, which is columns and rows of views.
    pub fn pitch(&self) -> [u32; 2] {
        self.pitch
    }

    /// Columns and rows of micro-images; this is the size of a view, px.
    pub fn view_size(&self) -> [u32; 2] {
        [0, 1].map(|axis| self.size[axis] / self.pitch[axis])
    }

    /// Columns and rows of pixels at the right and lower border that are no whole micro-image.
    pub fn left_over(&self) -> [u32; 2] {
        [0, 1].map(|axis| self.size[axis] % self.pitch[axis])
    }

    /// Reads the views of these cells (column and row in the micro-image) at once, in linear light. Takes 12 bytes per pixel of a view, and
    /// temporarily at most 6 more, and one row of the mosaic if it is a PNG, else the decoded file.
    ///
    /// # Errors
    /// The file cannot be read or decoded, has changed since it was opened, or exceeds the limits of `options`.
    ///
    /// # Panics
    /// If a cell is not below the pitch.
    pub fn views(&self, cells: &[[u32; 2]], options: &LoadOptions) -> Result<Vec<Photograph>, CaptureError> {
        assert!(cells.iter().all(|cell| cell[0] < self.pitch[0] && cell[1] < self.pitch[1]));
        let [width, height] = self.view_size().map(u64::from);
        let requested_pixels = width * height * cells.len() as u64;
        let limit = options.max_memory / (12 + 6);
        if requested_pixels > limit || u64::from(self.size[0]) * u64::from(self.size[1]) > options.max_texels
        {
            let (width, height) = (self.size[0], self.size[1]);
            return Err(PictureError::TooBig {
                file: self.file.clone(),
                width,
                height,
                limit: limit.min(options.max_texels),
            }
            .into());
        }
        match PngRows::open(&self.file, options.max_memory) {
            Some(rows) => {
                let rows = rows.map_err(|why| self.undecodable(why))?;
                self.sliced_rows(rows, cells)
            }
            None => {
                let whole = Photograph::read(&self.file, 1, options)?;
                self.check_size([whole.width, whole.height])?;
                Ok(cells.iter().map(|cell| self.slice(&whole, *cell)).collect())
            }
        }
    }

    fn undecodable(&self, why: String) -> CaptureError {
        PictureError::Undecodable { file: self.file.clone(), why: why.replace('\n', " ") }.into()
    }

    fn check_size(&self, size: [u32; 2]) -> Result<(), CaptureError> {
        let [actual, expected] = [size, self.size];
        if actual == expected {
            return Ok(());
        }
        Err(PictureError::SizeMismatch { file: self.file.clone(), actual, expected }.into())
    }

    fn slice(&self, whole: &Photograph, cell: [u32; 2]) -> Photograph {
        let [width, height] = self.view_size();
        let at = |x: u32, y: u32| {
            let (x, y) = (x * self.pitch[0] + cell[0], y * self.pitch[1] + cell[1]);
            whole.pixels[y as usize * whole.width as usize + x as usize]
        };
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| at(x, y))).collect();
        Photograph { width, height, pixels }
    }

    fn sliced_rows(&self, mut rows: PngRows, cells: &[[u32; 2]]) -> Result<Vec<Photograph>, CaptureError> {
        self.check_size(rows.size)?;
        let [width, height] = self.view_size();
        let (channels, is_deep, pixel_bytes) = (rows.channels, rows.is_deep, rows.pixel_bytes());
        // Three channels per pixel, of one byte or two.
        let sample_bytes = if is_deep { 2 } else { 1 };
        let mut stored = vec![Vec::<u8>::new(); cells.len()];
        for bytes in &mut stored {
            bytes.reserve_exact(width as usize * height as usize * 3 * sample_bytes);
        }
        for y in 0..height * self.pitch[1] {
            let row = rows.next().map_err(|why| self.undecodable(why))?;
            for (bytes, cell) in stored.iter_mut().zip(cells) {
                if y % self.pitch[1] != cell[1] {
                    continue;
                }
                for x in 0..width as usize {
                    let at = (x * self.pitch[0] as usize + cell[0] as usize) * pixel_bytes;
                    let pixel = &row[at..at + pixel_bytes];
                    for channel in 0..3 {
                        let channel = if channels < 3 { 0 } else { channel };
                        let sample = &pixel[channel * sample_bytes..(channel + 1) * sample_bytes];
                        bytes.extend_from_slice(sample);
                    }
                }
            }
        }
        let picture = |bytes: Vec<u8>| -> Option<DynamicImage> {
            if is_deep {
                let (pairs, _) = bytes.as_chunks::<2>();
                let samples = pairs.iter().map(|pair| u16::from_be_bytes(*pair)).collect();
                return ImageBuffer::from_raw(width, height, samples).map(DynamicImage::ImageRgb16);
            }
            ImageBuffer::from_raw(width, height, bytes).map(DynamicImage::ImageRgb8)
        };
        let mut views = Vec::with_capacity(cells.len());
        for bytes in stored {
            let picture = picture(bytes).ok_or_else(|| self.undecodable("it lacks pixels".into()))?;
            views.push(Photograph::from_image(picture, rows.profile.as_deref(), &self.file)?);
        }
        Ok(views)
    }
}

impl fmt::Debug for Mosaic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [[width, height], [across, down]] = [self.size, self.pitch];
        write!(f, "Mosaic({}, {width} × {height} by {across} × {down})", self.file.display())
    }
}
