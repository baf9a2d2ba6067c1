//! Scene and camera to light field.

use crate::Salf;
use lens::Camera;
use progress::{Cancelled, Progress};
use trace::{Radiance, Tracer};

/// How finely the light field is sampled.
#[derive(Clone, Copy, Debug)]
pub struct BakeOptions {
    /// The largest circle of confusion, px, that paint may give: how far outside the frame is sampled.
    pub margin_px: f64,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self { margin_px: 0.0 }
    }
}

/// Bakes the light field.
pub fn bake(
    _tracer: &Tracer,
    _radiance: &dyn Radiance,
    _camera: &Camera,
    _options: &BakeOptions,
    _progress: &dyn Progress,
) -> Result<Salf, Cancelled> {
    todo!()
}
