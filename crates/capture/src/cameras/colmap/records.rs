//! The content of COLMAP's files, text or binary.

use lens::CalibratedLens;
use std::collections::HashMap;

/// The lenses by COLMAP's ids, which have gaps.
pub(super) type Cameras = HashMap<u32, CalibratedLens>;

/// An entry of `images`.
pub(super) struct Image {
    pub place: String,
    pub name: String,
    pub camera: u32,
    /// (w, x, y, z) of the rotation from the world to the camera.
    pub quaternion: [f64; 4],
    pub translation: [f64; 3],
}
