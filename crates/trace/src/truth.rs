//! The ground truth: distributed ray tracing of the focus model.

use crate::{Radiance, Tracer};
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use scene::SurfaceField;

/// How the ground truth is sampled.
#[derive(Clone, Copy, Debug)]
pub struct TruthOptions {
    /// Rays a pixel of the frame and of its guard band.
    pub samples_per_pixel: u32,
    /// Seed of the scramble.
    pub seed: u32,
}

/// Renders `camera`'s picture of the scene in `tracer`, focused by `focus`.
pub fn render(
    _tracer: &Tracer,
    _radiance: &dyn Radiance,
    _focus: &dyn SurfaceField<FocusOffset>,
    _camera: &Camera,
    _options: &TruthOptions,
    _progress: &dyn Progress,
) -> Result<Picture, Cancelled> {
    todo!()
}
