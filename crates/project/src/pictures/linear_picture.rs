//! Reading pictures.

use crate::ProjectError;
use crate::color_space::{ColorSpace, transform_colors};
use crate::disk::extension;
use crate::openexr::image::{ExrAttribute, ExrImage, read_exr};
use crate::pictures::cryptomatte::is_cryptomatte;
use crate::pictures::output::{EXPOSURE, EXPOSURES};
use crate::pictures::png_file::read_image;
use lens::{Exposure, Picture};
use std::collections::BTreeMap;
use std::path::Path;

/// The linear value of an sRGB-encoded one, both in [0, 1]. Inverse of [`srgb_from_linear`](scene::srgb_from_linear).
pub(crate) fn linear_from_srgb(c: f32) -> f32 {
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// A picture that was read: linear RGB, and the other channels of its file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearPicture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear RGB a pixel, row 0 on top.
    pub rgb: Vec<[f32; 3]>,
    /// Further channels by name.
    pub layers: BTreeMap<String, Vec<f32>>,
    /// The exposure that it was written with, if the file gives it.
    pub exposure: Option<Exposure>,
}

impl LinearPicture {
    /// A picture under an exposure, as [`write_picture`](crate::write_picture) followed by [`read_picture`] would
    /// give it.
    pub fn from_picture(picture: &Picture, exposure: Exposure) -> Self {
        let layers = [("coverage".to_string(), picture.coverage.clone())].into();
        let rgb = picture.exposed(exposure);
        Self { width: picture.width, height: picture.height, rgb, layers, exposure: Some(exposure) }
    }
}

/// Reads a picture as linear RGB with Rec. 709 primaries: EXR (its display window, 0 where it has no pixels; R, G, B
/// of any precision, converted if the file declares other primaries; else a single grey channel), Radiance HDR, or an
/// sRGB picture of 8 or 16 bits (PNG, JPEG, WebP).
///
/// # Errors
/// The file cannot be read or decoded, or an EXR has no colours.
pub fn read_picture(file: &Path) -> Result<LinearPicture, ProjectError> {
    read_picture_mended(file, |_| {})
}

/// The same, with the pixels of EXR and HDR mended as they are stored: before colours are converted.
pub(crate) fn read_picture_mended(
    file: &Path,
    mut mend: impl FnMut(&mut [f32; 3]),
) -> Result<LinearPicture, ProjectError> {
    match extension(file).as_str() {
        "exr" => from_exr(file, read_exr(file, |_| 0.0)?, mend),
        "hdr" => {
            let image = read_image(file)?.into_rgb32f();
            let mut rgb: Vec<_> = image.pixels().map(|p| p.0).collect();
            rgb.iter_mut().for_each(&mut mend);
            Ok(LinearPicture {
                width: image.width(),
                height: image.height(),
                rgb,
                ..LinearPicture::default()
            })
        }
        _ => {
            let (width, height, stored) = crate::pictures::png_file::read_stored_rgb(file)?;
            let rgb = stored.into_iter().map(|c| c.map(linear_from_srgb)).collect();
            Ok(LinearPicture { width, height, rgb, ..LinearPicture::default() })
        }
    }
}

fn from_exr(
    file: &Path,
    mut exr: ExrImage,
    mut mend: impl FnMut(&mut [f32; 3]),
) -> Result<LinearPicture, ProjectError> {
    // R, G, B without a prefix, or those of the first layer that has them.
    let has_colors =
        |prefix: &str| ["R", "G", "B"].iter().all(|c| exr.channels.contains_key(&format!("{prefix}{c}")));
    let layer_prefixes = exr.channels.keys().filter_map(|name| name.strip_suffix('R'));
    let layer_prefixes = layer_prefixes.filter(|prefix| prefix.ends_with('.') && !is_cryptomatte(prefix));
    let prefix = std::iter::once("").chain(layer_prefixes).find(|prefix| has_colors(prefix));
    let prefix = prefix.map(str::to_owned);
    let grey = || ["Y", "V"].into_iter().find(|name| exr.channels.contains_key(*name)).map(str::to_owned);
    let single = || (exr.channels.len() == 1).then(|| exr.channels.keys().next().cloned()).flatten();
    let rgb = if let Some(prefix) = prefix {
        let [r, g, b] =
            ["R", "G", "B"].map(|c| exr.channels.remove(&format!("{prefix}{c}")).unwrap_or_default());
        let mut rgb: Vec<_> = r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect();
        rgb.iter_mut().for_each(&mut mend);
        let rec709 = ColorSpace::Rec709.chromaticities();
        if let Some(matrix) =
            exr.chromaticities.filter(|c| !c.is_close_to(&rec709)).and_then(|c| c.matrix_to(&rec709))
        {
            transform_colors(&matrix, &mut rgb);
        }
        rgb
    } else if let Some(name) = grey().or_else(single) {
        let mut rgb: Vec<_> = exr.channels[&name].iter().map(|&y| [y; 3]).collect();
        rgb.iter_mut().for_each(&mut mend);
        rgb
    } else {
        let names: Vec<_> = exr.channels.keys().cloned().collect();
        let problem = format!("has no channels R, G, B, only {}", names.join(", "));
        return Err(ProjectError::content(file, problem, "give an EXR with R, G and B, or one channel"));
    };
    let exposure = EXPOSURES.iter().find(
        |(_, name)| matches!(exr.attributes.get(EXPOSURE), Some(ExrAttribute::Text(text)) if text == name),
    );
    let exposure = exposure.map(|(exposure, _)| *exposure);
    Ok(LinearPicture { width: exr.width, height: exr.height, rgb, layers: exr.channels, exposure })
}
