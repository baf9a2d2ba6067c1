//! How the ground truth is sampled.

use super::filter::ReconstructionFilter;
use lens::Camera;

/// Where rays start. Both estimators have the same expectation and share nothing but lens, tracer and
/// radiance, so that each checks the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Estimator {
    /// At the sensor: an ordinary camera's rays; what they hit is sent back to the sensor with its own focus.
    /// The better one nearly always.
    #[default]
    Sensor,
    /// At points spread over the surfaces and the sky, each ray weighed with what it takes of the picture.
    Surface,
}

/// What the samples are drawn from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Sampler {
    /// Sobol' points, Owen-scrambled: errors fall faster than with independent ones.
    #[default]
    LowDiscrepancy,
    /// Independent random numbers: errors fall with the square root of the samples.
    Independent,
}

/// A rectangle of pixels; (0, 0) is the frame's upper left one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Region {
    /// The whole picture of a camera.
    pub fn frame(camera: &Camera) -> Self {
        Self { x: 0, y: 0, width: camera.width, height: camera.height }
    }

    /// What of the region lies in the camera's picture; possibly nothing.
    pub fn within(self, camera: &Camera) -> Self {
        let (x, y) = (self.x.min(camera.width), self.y.min(camera.height));
        Self { x, y, width: self.width.min(camera.width - x), height: self.height.min(camera.height - y) }
    }

    /// The number of pixels in it.
    pub fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }
}

/// How the ground truth is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthOptions {
    /// Rays a pixel, of the picture and of what around it can send light into it; 0 counts as 1. The surface
    /// estimator sends about as many rays in all.
    pub samples_per_pixel: u32,
    /// Seed of all random numbers.
    pub seed: u32,
    /// Where rays start.
    pub estimator: Estimator,
    /// What the samples are drawn from.
    pub sampler: Sampler,
    /// How samples become pixels.
    pub filter: ReconstructionFilter,
    /// Which pixels to render; `None` is the frame.
    pub region: Option<Region>,
    /// Whether a few rays per pixel are traced in advance to choose sample sequences. Without, pictures of one camera and
    /// focus are made of the same rays, whatever the light.
    pub surveys_light: bool,
}

impl Default for TruthOptions {
    fn default() -> Self {
        Self {
            samples_per_pixel: 256,
            seed: 0,
            estimator: Estimator::default(),
            sampler: Sampler::default(),
            filter: ReconstructionFilter::default(),
            region: None,
            surveys_light: true,
        }
    }
}

/// Passes that a render has at least, if it has as many samples: from their scatter comes the standard error,
/// and with fewer its own error would show (Student's t with this many degrees of freedom less one).
const MIN_PASSES: u32 = 32;
/// Samples of a pass at most: the length of a Sobol' sequence.
pub(super) const MAX_SAMPLES_OF_PASS: u32 = 1 << 16;

impl TruthOptions {
    /// Samples a pixel of one pass: a power of two, so that a pass is itself a set of low discrepancy.
    pub fn samples_of_pass(&self) -> u32 {
        let target_samples = self.samples_per_pixel / MIN_PASSES;
        if target_samples == 0 { 1 } else { (1 << target_samples.ilog2()).min(MAX_SAMPLES_OF_PASS) }
    }
}
