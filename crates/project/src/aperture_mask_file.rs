//! Aperture masks: pictures of what an aperture lets pass.

use crate::ProjectError;
use crate::disk::extension;
use crate::picture_file::read_picture;
use crate::png_file::read_stored_rgb;
use lens::ApertureMask;
use std::path::Path;

/// Reads a picture as an aperture mask: the mean of red, green and blue as stored (no sRGB decoding), in [0, 1], is the
/// transmission; an EXR's values are clipped to that. `name` is kept as the mask's file.
pub fn read_aperture_mask(file: &Path, name: &str) -> Result<ApertureMask, ProjectError> {
    let (width, height, texels) = if extension(file) == "exr" {
        let picture = read_picture(file)?;
        (picture.width, picture.height, picture.rgb)
    } else {
        read_stored_rgb(file)?
    };
    let mean = |rgb: &[f32; 3]| rgb.iter().map(|c| c.clamp(0.0, 1.0)).sum::<f32>() / 3.0;
    let transmission = texels.iter().map(mean).collect();
    Ok(ApertureMask { width, height, transmission, file: name.to_string() })
}
