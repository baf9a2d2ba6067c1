//! Depth in an EXR: the depth channel, or the only channel.

use super::stored::{Numbers, Stored};
use crate::CaptureError;
use crate::pictures::exr_channels::{depth_channel, exr_names, read_exr};
use scene::LoadOptions;
use std::path::Path;

/// Reads the numbers of an EXR that is a depth map, and whether its channel's name denotes depth.
pub(crate) fn read_exr_depth(file: &Path, options: &LoadOptions) -> Result<(Stored, bool), CaptureError> {
    let names = exr_names(file, options)?;
    let named = depth_channel(&names);
    let is_named = named.is_some();
    let only = || {
        // One channel, or three that are the same.
        let first = ["R", "Y", "V"].into_iter().find(|candidate| names.iter().any(|name| name == candidate));
        if names.len() == 1 { names.first().cloned() } else { first.map(String::from) }
    };
    let Some(name) = named.or_else(only) else {
        let what = format!(
            "has no depth channel (Z, depth.Z, ViewLayer.Depth.Z, Depth.V), only {}",
            names.join(", ")
        );
        return Err(CaptureError::malformed(file, "EXR", what.chars().take(300).collect::<String>()));
    };
    Ok((read_exr_channel(file, &name, options)?, is_named))
}

/// Reads the numbers of a channel.
pub(crate) fn read_exr_channel(
    file: &Path,
    channel: &str,
    options: &LoadOptions,
) -> Result<Stored, CaptureError> {
    let read = read_exr(file, &[channel], options)?;
    let [width, height] = read.size;
    let values = read.channels.into_iter().next().unwrap_or_default();
    Ok(Stored { width, height, values, numbers: Numbers::Floats })
}
