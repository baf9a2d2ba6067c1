//! The small picture inside a project, for file managers.

use crate::ProjectError;
use crate::disk::{read_bytes, write_bytes};
use crate::pictures::linear_picture::linear_from_srgb;
use crate::pictures::output::srgb_bytes;
use crate::pictures::png_file::{decode, encode_rgb8};
use crate::project_file::container::Container;
use crate::project_file::manifest::Manifest;
use scene::Photograph;
use std::path::Path;

/// Its container entry.
pub(crate) const THUMBNAIL: &str = "thumbnail.png";

/// Maximum size that is read, bytes.
pub(crate) const MAX_BYTES: u64 = 4 << 20;

/// Maximum length of its longer side, px: the largest that file managers request.
const SIDE_PX: u32 = 512;

/// A small picture: 8-bit sRGB PNG, at most `SIDE_PX` on its longer side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thumbnail(pub(crate) Vec<u8>);

impl Thumbnail {
    /// A thumbnail of a picture as a screen shows it: linear RGB, clipped to [0, 1], row by row.
    ///
    /// # Panics
    /// If the number of pixels does not match, or is 0.
    pub fn from_linear(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> Self {
        Self::encode_reduced(width, height, pixels, SIDE_PX)
    }

    fn encode_reduced(width: u32, height: u32, mut pixels: Vec<[f32; 3]>, side_px: u32) -> Self {
        assert_eq!(pixels.len(), width as usize * height as usize);
        // Without clipping, one lamp of a million would dominate the mean.
        pixels.iter_mut().flatten().for_each(|value| *value = value.clamp(0.0, 1.0));
        let whole = Photograph { width, height, pixels };
        let small = whole.downsampled(width.max(height).div_ceil(side_px.max(1)).max(1));
        let bytes = encode_rgb8(small.width, small.height, &srgb_bytes(&small.pixels), &[]);
        Self(bytes.expect("memory takes any PNG"))
    }

    /// Reads the thumbnail of a project file; `None` if it was saved without one.
    ///
    /// # Errors
    /// The file cannot be read or is not a project.
    pub fn read(file: &Path) -> Result<Option<Self>, ProjectError> {
        let bytes = read_bytes(file)?;
        let mut container = Container::open(file, &bytes)?;
        let manifest = Manifest::read(file, &mut container)?;
        Self::from_container(file, &manifest, &mut container)
    }

    pub(crate) fn from_container(
        file: &Path,
        manifest: &Manifest,
        container: &mut Container<'_>,
    ) -> Result<Option<Self>, ProjectError> {
        let is_there = manifest.checksums.contains_key(THUMBNAIL);
        is_there.then(|| manifest.read_entry(file, container, THUMBNAIL, MAX_BYTES).map(Self)).transpose()
    }

    /// The thumbnail with its longer side at most `side_px`.
    ///
    /// # Errors
    /// A sentence, if the PNG cannot be decoded.
    pub fn reduced_to(&self, side_px: u32) -> Result<Self, String> {
        let image = decode(&self.0)?.into_rgb8();
        let (width, height) = image.dimensions();
        if width.max(height) <= side_px {
            return Ok(self.clone());
        }
        let linear = |pixel: &image::Rgb<u8>| pixel.0.map(|value| linear_from_srgb(f32::from(value) / 255.0));
        Ok(Self::encode_reduced(width, height, image.pixels().map(linear).collect(), side_px))
    }

    /// Writes it as PNG, whatever the file's extension.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, file: &Path) -> Result<(), ProjectError> {
        write_bytes(file, &self.0)
    }

    /// The bytes of the thumbnail's PNG.
    pub fn png(&self) -> &[u8] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn size(thumbnail: &Thumbnail) -> (u32, u32) {
        let image = decode(thumbnail.png()).unwrap();
        (image.width(), image.height())
    }

    #[test]
    fn pictures_become_small_and_keep_their_mean() {
        let shown: Vec<[f32; 3]> = (0..1600 * 700).map(|k| [(k % 2) as f32 * 1e6, 0.5, 0.0]).collect();
        let thumbnail = Thumbnail::from_linear(1600, 700, shown);
        assert_eq!(size(&thumbnail), (400, 175));
        let smaller = thumbnail.reduced_to(128).unwrap();
        assert_eq!(size(&smaller), (100, 44));
        let image = decode(smaller.png()).unwrap().into_rgb8();
        // Half the light of a white pixel, and grey of a half, are the same in sRGB's encoding.
        assert_eq!(image.get_pixel(50, 20).0, [188, 188, 0]);
        assert_eq!(smaller.reduced_to(128).unwrap(), smaller, "small enough already");
    }

    #[test]
    fn a_broken_picture_is_an_error() {
        assert!(Thumbnail(b"no picture".to_vec()).reduced_to(64).is_err());
    }
}
