//! The pixels of a view, read on demand: linear light, oriented as its lens.

use super::View;
use super::linear_conversion::{LinearConversion, UnsupportedProfile};
use crate::{LoadOptions, open_picture};
use glam::{DVec2, UVec2, Vec3};
use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, Limits};
use std::io::{BufRead, BufReader, Cursor, Seek};
use std::path::{Path, PathBuf};

/// The pixels of a photograph.
#[derive(Clone, Debug, PartialEq)]
pub struct Photograph {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear RGB with the primaries of sRGB, row 0 on top; 1 is the picture's white. Colours outside sRGB's gamut
    /// have components below 0 or above 1.
    pub pixels: Vec<[f32; 3]>,
}

/// Why the pixels of a picture cannot be read. Displays as `FILE: what is wrong (what to do)`.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source} (check the path and its permissions)", file.display())]
    Unreadable {
        /// The picture.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is not a picture, or it is broken.
    #[error("{}: cannot be decoded: {why} (give it as PNG, JPEG, WebP or HDR)", file.display())]
    Undecodable {
        /// The picture.
        file: PathBuf,
        /// Why.
        why: String,
    },
    /// Its size is not that of its lens.
    #[error(
        "{}: is {} × {} px, its camera is for {} × {} px (give the pictures that the cameras were computed from)",
        file.display(), actual[0], actual[1], expected[0], expected[1]
    )]
    SizeMismatch {
        /// The picture.
        file: PathBuf,
        /// Its size, after orientation.
        actual: [u32; 2],
        /// The lens's size.
        expected: [u32; 2],
    },
    /// It exceeds the size limit.
    #[error("{}: {width} × {height} px are beyond the limit of {limit} px (make the pictures smaller)", file.display())]
    TooBig {
        /// The picture.
        file: PathBuf,
        /// Its columns.
        width: u32,
        /// Its rows.
        height: u32,
        /// Maximum number of pixels.
        limit: u64,
    },
    /// Its colour profile is unsupported.
    #[error("{}: its ICC profile {why} (convert the pictures to sRGB)", file.display())]
    Profile {
        /// The picture.
        file: PathBuf,
        /// What is wrong with it.
        why: String,
    },
}

impl Photograph {
    /// Reads a picture file as [`View::read_photograph`] does, of any size, with an EXIF orientation (1: as it is
    /// stored).
    ///
    /// # Errors
    /// The file cannot be read or decoded, or exceeds the limits of `options`.
    pub fn read(file: &Path, orientation: u8, options: &LoadOptions) -> Result<Self, PictureError> {
        let (picture, profile) = decode_file(file, orientation, options)?;
        Self::from_image(picture, profile.as_deref(), file)
    }

    /// The same for the bytes of a picture that lies within a `file`.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn decode(
        bytes: &[u8],
        file: &Path,
        orientation: u8,
        options: &LoadOptions,
    ) -> Result<Self, PictureError> {
        let (picture, profile) = decode(Cursor::new(bytes), file, orientation, options)?;
        Self::from_image(picture, profile.as_deref(), file)
    }

    /// The linear light of pixels that were decoded from a `file`, by its ICC profile or in sRGB; floats are linear.
    ///
    /// # Errors
    /// The profile is unsupported.
    pub fn from_image(
        picture: DynamicImage,
        profile: Option<&[u8]>,
        file: &Path,
    ) -> Result<Self, PictureError> {
        let colors = LinearConversion::from_profile(profile, &picture)
            .map_err(|UnsupportedProfile(why)| PictureError::Profile { file: file.into(), why })?;
        let (width, height) = (picture.width(), picture.height());
        Ok(Self { width, height, pixels: colors.to_linear(picture) })
    }

    /// The value from which on the sensor was saturated; infinite if the picture has values above white and thus no
    /// saturation there.
    pub fn clipping_level(&self) -> f32 {
        /// JPEG and demosaicking leave saturated pixels a little below white.
        const AT_LIMIT: f32 = 0.985;
        let mut finite = self.pixels.iter().flatten().filter(|value| value.is_finite());
        if finite.all(|value| *value <= 1.0) { AT_LIMIT } else { f32::INFINITY }
    }

    /// The same downsampled: each pixel is the mean of `factor` × `factor` pixels (fewer at the right and lower
    /// border).
    pub fn downsampled(&self, factor: u32) -> Self {
        if factor <= 1 {
            return self.clone();
        }
        let [width, height] = [self.width, self.height].map(|side| side.div_ceil(factor));
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let (mut sum, mut count) = ([0.0; 3], 0.0);
            for row in y * factor..((y + 1) * factor).min(self.height) {
                for column in x * factor..((x + 1) * factor).min(self.width) {
                    let pixel = self.pixels[(row * self.width + column) as usize];
                    (0..3).for_each(|channel| sum[channel] += pixel[channel]);
                    count += 1.0;
                }
            }
            pixels.push(sum.map(|sum: f32| sum / count));
        }
        Self { width, height, pixels }
    }

    /// The light at a pixel position ((0.5, 0.5) the centre of the upper left pixel), bilinear; beyond the border the
    /// border continues.
    pub fn sample(&self, pixel: DVec2) -> Vec3 {
        let last = UVec2::new(self.width - 1, self.height - 1);
        let place = (pixel - 0.5).clamp(DVec2::ZERO, last.as_dvec2());
        let corner = place.floor().as_uvec2();
        let [right, down] = (place - place.floor()).as_vec2().to_array();
        let pixel = |step: UVec2| {
            let at = (corner + step).min(last);
            Vec3::from(self.pixels[(at.y * self.width + at.x) as usize])
        };
        let row = |y: u32| pixel(UVec2::new(0, y)).lerp(pixel(UVec2::new(1, y)), right);
        row(0).lerp(row(1), down)
    }
}

impl View {
    /// Reads the picture: PNG, JPEG, WebP or Radiance HDR, 8 or 16 bits, grey or colour, with its ICC profile or in
    /// sRGB; transparent pixels count as opaque. Takes 12 bytes per pixel and, during the call, the memory of the
    /// decoded file.
    ///
    /// # Errors
    /// The file cannot be read or decoded, exceeds the limits of `options`, or does not have the lens's size.
    pub fn read_photograph(&self, options: &LoadOptions) -> Result<Photograph, PictureError> {
        let (picture, profile) = decode_file(&self.picture, self.orientation, options)?;
        let (width, height) = (picture.width(), picture.height());
        if [width, height] != self.lens.size_px() {
            let (actual, expected) = ([width, height], self.lens.size_px());
            return Err(PictureError::SizeMismatch { file: self.picture.clone(), actual, expected });
        }
        Photograph::from_image(picture, profile.as_deref(), &self.picture)
    }
}

/// Decodes a picture file with an EXIF orientation; returns it with its ICC profile.
pub(super) fn decode_file(
    file: &Path,
    orientation: u8,
    options: &LoadOptions,
) -> Result<(DynamicImage, Option<Vec<u8>>), PictureError> {
    let unreadable = |source| PictureError::Unreadable { file: file.into(), source };
    decode(BufReader::new(std::fs::File::open(file).map_err(unreadable)?), file, orientation, options)
}

/// The same for the bytes of a picture, which are in `file`.
fn decode(
    input: impl BufRead + Seek,
    file: &Path,
    orientation: u8,
    options: &LoadOptions,
) -> Result<(DynamicImage, Option<Vec<u8>>), PictureError> {
    let broken = |error: image::ImageError| PictureError::Undecodable {
        file: file.into(),
        why: error.to_string().replace('\n', " "),
    };
    let mut limits = Limits::default();
    limits.max_alloc = Some(options.max_memory);
    let mut decoder = open_picture(input, limits).map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let pixels = u64::from(width) * u64::from(height);
    // Decoded and converted at the same time.
    let limit = options.max_texels.min(options.max_memory / (12 + 8));
    if pixels > limit {
        return Err(PictureError::TooBig { file: file.into(), width, height, limit });
    }
    // An unreadable profile counts as none: the pixels are still there.
    let profile = decoder.icc_profile().ok().flatten();
    let mut picture = DynamicImage::from_decoder(decoder).map_err(broken)?;
    picture.apply_orientation(Orientation::from_exif(orientation).unwrap_or(Orientation::NoTransforms));
    Ok((picture, profile))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_between_pixels_and_beyond_the_border() {
        let pixels = [0.0, 1.0, 2.0, 7.0].map(|v| [v; 3]).to_vec();
        let photograph = Photograph { width: 2, height: 2, pixels };
        let at = |x: f64, y: f64| photograph.sample(DVec2::new(x, y)).x;
        assert_eq!([at(0.5, 0.5), at(1.5, 1.5), at(1.0, 1.0), at(1.25, 0.5)], [0.0, 7.0, 2.5, 0.75]);
        assert_eq!([at(-9.0, 0.2), at(1.9, 9.0)], [0.0, 7.0]);
        let pixels = (0..6).map(|v| [v as f32; 3]).collect();
        let small = Photograph { width: 3, height: 2, pixels }.downsampled(2);
        assert_eq!((small.width, small.height, small.pixels), (2, 1, vec![[2.0; 3], [3.5; 3]]));
    }
}
