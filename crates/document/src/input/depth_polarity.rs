//! The question to the user if a depth map does not say which end is near.

use crate::error::DocumentError;
use capture::{NearEnd, read_depth_map};
use scene::LoadOptions;
use std::path::PathBuf;

/// Maximum length of the longer side of the map as it is shown, px.
const SIDE_PX: usize = 240;

/// A depth map that does not say which end is near, prepared to be shown in both ways.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthPolarityRequest {
    /// The capture to open.
    pub capture: PathBuf,
    /// The file of the depth map.
    pub map: PathBuf,
    /// Columns and rows of the map as it is shown.
    pub size: [usize; 2],
    /// Nearness in [0, 1] if white, or greater values, are near, row by row.
    pub nearness: Vec<f32>,
}

impl DepthPolarityRequest {
    /// Reads the depth map `map` of `capture`.
    ///
    /// # Errors
    /// The map cannot be read.
    pub fn from_map(capture: PathBuf, map: PathBuf) -> Result<Self, DocumentError> {
        let depth_map = read_depth_map(&map, None, Some(NearEnd::White), &LoadOptions::default())?;
        let [width, height] = [depth_map.width, depth_map.height].map(|side| side as usize);
        let stride = width.max(height).div_ceil(SIDE_PX).max(1);
        let size = [width.div_ceil(stride), height.div_ceil(stride)];
        let value_at =
            |index: usize| depth_map.values[index / size[0] * stride * width + index % size[0] * stride];
        let nearness_or_zero = |value: f32| if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) };
        let nearness = (0..size[0] * size[1]).map(|index| nearness_or_zero(value_at(index))).collect();
        Ok(Self { capture, map, size, nearness })
    }
}
