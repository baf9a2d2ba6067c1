//! Sources of a picture's pixels: a file, a part of one, channels of an EXR, or every n-th pixel of a mosaic.
//!
//! Pixels are not cached; [`PictureSource::photograph`] reads them when they are needed, one picture at a time.

use crate::CaptureError;
use crate::mosaic::Mosaic;
use crate::pictures::exr_channels::read_exr;
use scene::{LoadOptions, Photograph};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where the pixels of a picture come from.
#[derive(Clone, PartialEq)]
pub enum PictureSource {
    /// A picture file, as [`scene::View::read_photograph`] reads them.
    File {
        /// The file.
        file: PathBuf,
        /// The EXIF orientation (1 to 8) that transforms its pixels into the picture; 1: unchanged.
        orientation: u8,
    },
    /// A picture that is embedded in a file.
    Within {
        /// The file.
        file: PathBuf,
        /// A whole PNG or JPEG.
        bytes: Arc<[u8]>,
        /// EXIF orientation, as for a file.
        orientation: u8,
    },
    /// Three channels of an EXR, linear light; missing pixels are black.
    Exr {
        /// The file.
        file: PathBuf,
        /// Red, green, blue.
        channels: [String; 3],
    },
    /// One view of a mosaic of micro-images.
    MicroImages {
        /// The mosaic.
        mosaic: Mosaic,
        /// Column and row of the pixel in each micro-image, from 0.
        cell: [u32; 2],
    },
}

impl PictureSource {
    /// A file's picture as it is stored.
    pub(crate) fn stored(file: &Path) -> Self {
        Self::File { file: file.into(), orientation: 1 }
    }

    /// The file that holds it.
    pub fn file(&self) -> &Path {
        match self {
            Self::File { file, .. } | Self::Within { file, .. } | Self::Exr { file, .. } => file,
            Self::MicroImages { mosaic, .. } => mosaic.file(),
        }
    }

    /// Reads the picture in linear light. Takes 12 bytes per pixel, and temporarily the memory of the decoded file; for a mosaic that is a PNG,
    /// of one row.
    ///
    /// Several views of one mosaic are read faster by [`Mosaic::views`].
    ///
    /// # Errors
    /// The file cannot be read or decoded, or exceeds the limits of `options`.
    pub fn photograph(&self, options: &LoadOptions) -> Result<Photograph, CaptureError> {
        match self {
            Self::File { file, orientation } => Ok(Photograph::read(file, *orientation, options)?),
            Self::Within { file, bytes, orientation } => {
                Ok(Photograph::decode(bytes, file, *orientation, options)?)
            }
            Self::Exr { file, channels } => {
                let names = channels.each_ref().map(String::as_str);
                let read = read_exr(file, &names, options)?;
                let [width, height] = read.size;
                let finite = |value: f32| if value.is_finite() { value } else { 0.0 };
                let [red, green, blue] = &read.channels[..] else { unreachable!("as many as were wanted") };
                let pixels = red.iter().zip(green).zip(blue);
                let pixels = pixels.map(|((red, green), blue)| [*red, *green, *blue].map(finite)).collect();
                Ok(Photograph { width, height, pixels })
            }
            Self::MicroImages { mosaic, cell } => {
                let mut views = mosaic.views(&[*cell], options)?;
                Ok(views.remove(0))
            }
        }
    }
}

impl fmt::Debug for PictureSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { file, orientation } => write!(f, "File({}, {orientation})", file.display()),
            Self::Within { file, bytes, orientation } => {
                write!(f, "Within({}, {} bytes, {orientation})", file.display(), bytes.len())
            }
            Self::Exr { file, channels } => write!(f, "Exr({}, {channels:?})", file.display()),
            Self::MicroImages { mosaic, cell } => write!(f, "MicroImages({mosaic:?}, {cell:?})"),
        }
    }
}
