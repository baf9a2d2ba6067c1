//! The differences between two pictures, as a file.
//!
//! **PNG**: FLIP in false colours (magma: black where the pictures are alike, through purple and orange to pale
//! yellow where they differ most). **EXR**: |a − b| as linear `R`, `G`, `B`, and `flip` in [0, 1].

use crate::disk::{extension, write_bytes};
use crate::openexr::image::{ExrImage, write_exr};
use crate::openexr::options::ExrOptions;
use crate::pictures::compare::{ErrorMaps, error_maps};
use crate::pictures::layer::color_channels;
use crate::pictures::png_file::encode_rgb8;
use crate::{LinearPicture, ProjectError};
use nv_flip::FlipImageFloat;
use std::collections::BTreeMap;
use std::path::Path;

/// Writes the differences of `a` from the reference `b`, as PNG or EXR by extension.
///
/// # Errors
/// The sizes differ, the extension is another, or the file cannot be written.
pub fn write_error_map(file: &Path, a: &LinearPicture, b: &LinearPicture) -> Result<(), ProjectError> {
    let maps = error_maps(a, b)?;
    let (width, height) = (a.width, a.height);
    match extension(file).as_str() {
        "png" => {
            let bytes = encode_rgb8(width, height, &false_color_bytes(width, height, &maps), &[]).map_err(
                |error| ProjectError::Write { file: file.to_owned(), source: std::io::Error::other(error) },
            )?;
            write_bytes(file, &bytes)
        }
        "exr" => {
            let mut channels: BTreeMap<_, _> = color_channels(&maps.difference).into();
            channels.insert("flip".to_string(), maps.flip);
            let image = ExrImage { width, height, channels, ..ExrImage::default() };
            write_exr(file, image, ExrOptions::default())
        }
        _ => Err(ProjectError::content(
            file,
            "error maps cannot be written in this format",
            "name a .png or .exr",
        )),
    }
}

/// The differences of `a` from the reference `b`, in the false colours of [`write_error_map`]: 8-bit sRGB,
/// interleaved, row 0 on top.
///
/// # Errors
/// The sizes differ.
pub fn false_color_error_map(a: &LinearPicture, b: &LinearPicture) -> Result<Vec<u8>, ProjectError> {
    Ok(false_color_bytes(a.width, a.height, &error_maps(a, b)?))
}

/// FLIP in its authors' false colours, 8-bit sRGB, interleaved.
fn false_color_bytes(width: u32, height: u32, maps: &ErrorMaps) -> Vec<u8> {
    FlipImageFloat::with_data(width, height, &maps.flip).apply_color_lut(&nv_flip::magma_lut()).to_vec()
}
