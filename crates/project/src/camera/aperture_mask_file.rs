//! Aperture masks: pictures of an aperture's transmission.

use crate::ProjectError;
use crate::disk::extension;
use crate::pictures::linear_picture::read_picture;
use crate::pictures::png_file::read_stored_rgb;
use lens::ApertureMask;
use std::path::Path;

/// Reads a picture as an aperture mask: the mean of red, green and blue as stored (no sRGB decoding), in [0, 1], is
/// the transmission; an EXR's values are clipped to that range. `name` is stored as the mask's file.
///
/// # Errors
/// The file cannot be read or decoded.
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
