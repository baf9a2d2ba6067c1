//! What surfaces of light fields and of pictures with depth have in common.

use crate::error::DocumentError;
use light::Steps;
use capture::CaptureError;
use lens::{Camera, Picture};
use relief::ReliefError;
use scene::{Photograph, Scene};
use std::path::Path;

/// The angle of view across a picture's longer side where no file tells it: that of a lens of 50 mm on a frame of 36.
const DEFAULT_LONGER_ANGLE: f64 = 0.6911;

/// A surface made from one picture, or several of one place.
pub(crate) struct PictureSurface {
    pub scene: Scene,
    /// The camera of the picture.
    pub camera: Camera,
    /// What is good to know, a sentence each.
    pub remarks: Vec<String>,
    /// Whether something is missing.
    pub is_incomplete: bool,
}

/// The longest side of a picture that is shown before it has a surface, px.
const MAX_EARLY_PICTURE_PX: u32 = 1000;

/// Shows a picture while its surface is made.
pub(crate) fn show_early_picture(picture: &Photograph, steps: &dyn Steps) {
    let longer = picture.width.max(picture.height);
    let Photograph { width, height, pixels } = picture.downsampled(longer.div_ceil(MAX_EARLY_PICTURE_PX));
    let coverage = vec![1.0; pixels.len()];
    steps.picture_ready(&Picture { width, height, radiance: pixels, coverage });
}

/// A picture, if it is still of the size that its file had a moment ago.
pub(crate) fn check_size(
    photograph: Photograph,
    size: [u32; 2],
    path: &Path,
) -> Result<Photograph, DocumentError> {
    if [photograph.width, photograph.height] == size {
        return Ok(photograph);
    }
    let what = format!(
        "has changed while it was opened: {} × {} px became {} × {} (open it again)",
        size[0], size[1], photograph.width, photograph.height
    );
    Err(DocumentError::bad_file(path, what))
}

/// How far the surface goes on around the picture for blur of at most this radius, px.
pub(crate) fn margin_px(size: [usize; 2], largest_px: f64) -> usize {
    /// Of the shorter side: more would rather be seen as what it is, invented.
    const MAX_SHARE: f64 = 0.2;
    let max_px = MAX_SHARE * size[0].min(size[1]) as f64;
    largest_px.min(max_px).ceil() as usize
}

/// The least and the greatest.
pub(crate) fn finite_range(values: &[f32]) -> [f64; 2] {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    let [low, high] = finite
        .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    if low <= high { [low, high].map(f64::from) } else { [0.0; 2] }
}

/// Focal length in pixels where nothing is known of the lens.
pub(crate) fn default_focal_px(size: [u32; 2]) -> f64 {
    0.5 * f64::from(size[0].max(size[1])) / (0.5 * DEFAULT_LONGER_ANGLE).tan()
}

/// Why there is no surface, as it is shown.
pub(crate) fn relief_error(error: ReliefError<CaptureError>) -> DocumentError {
    match error {
        ReliefError::Cancelled(_) => DocumentError::Cancelled,
        ReliefError::View(error) => error.into(),
    }
}
