//! Reading a depth map, in any of its file formats.

use super::exr_depth::{read_exr_channel, read_exr_depth};
use super::levels::levels_of;
use super::map::DepthMap;
use super::meaning::{DepthHint, DepthQuantity};
use super::near_end::NearEnd;
use super::pfm::read_pfm;
use crate::CaptureError;
use crate::files::whole_file::whole_file;
use scene::LoadOptions;
use std::path::Path;

/// Reads a depth or disparity map: PFM, EXR, or a grey picture (PNG of 8 or 16 bits, JPEG, WebP).
///
/// `quantity` determines what its numbers are, else its file name (`…disp…`, `…depth…`) or its channel's name. Levels of grey are relative,
/// and so are floats if `near` is given: then `near` determines the near end, or that they are disparities.
/// Distances that are 0, negative or NaN are unknown, infinite ones and those from 10¹⁰ on are background; disparities that are not finite
/// are unknown.
///
/// # Errors
/// The file cannot be read, is malformed or exceeds the limits, or is relative and its near end is unknown.
pub fn read_depth_map(
    file: &Path,
    quantity: Option<DepthQuantity>,
    near: Option<NearEnd>,
    options: &LoadOptions,
) -> Result<DepthMap, CaptureError> {
    let extension = file.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    let mut hint = DepthHint { quantity, near };
    let stored = match extension.as_deref() {
        Some("exr") => {
            let (stored, is_named) = read_exr_depth(file, options)?;
            if is_named {
                hint.quantity = quantity.or(Some(DepthQuantity::Depth));
            }
            stored
        }
        Some("pfm") => {
            let bytes = whole_file(file, options.max_memory / 2)?;
            read_pfm(file, &bytes, options.max_texels.min(options.max_memory / 16))?
        }
        _ => {
            let bytes = whole_file(file, options.max_memory / 4)?;
            levels_of(&bytes, options).map_err(|why| CaptureError::malformed(file, "picture", why))?
        }
    };
    stored.into_depth_map(file, hint)
}

/// Reads the depth map in a channel of an EXR: distances, unless `near` is given.
///
/// # Errors
/// As [`read_depth_map`]; or there is no such channel.
pub(crate) fn read_depth_channel(
    file: &Path,
    channel: &str,
    near: Option<NearEnd>,
    options: &LoadOptions,
) -> Result<DepthMap, CaptureError> {
    let hint = DepthHint { quantity: Some(DepthQuantity::Depth), near };
    read_exr_channel(file, channel, options)?.into_depth_map(file, hint)
}
