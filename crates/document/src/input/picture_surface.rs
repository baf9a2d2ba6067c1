//! Common parts of surfaces made from light fields and from pictures with depth.

use crate::error::DocumentError;
use capture::CaptureError;
use lens::{Camera, Picture};
use light::Steps;
use relief::ReliefError;
use scene::{Photograph, Scene};
use std::path::Path;

/// The angle of view across a picture's longer side if no file specifies it, rad: that of a 50 mm lens on a 36 mm frame.
const DEFAULT_LONGER_ANGLE: f64 = 0.6911;

/// A surface made from one picture, or from several of one place.
pub(crate) struct PictureSurface {
    pub scene: Scene,
    /// The camera of the picture.
    pub camera: Camera,
    /// Anything missing or worth knowing, a sentence each.
    pub remarks: Vec<String>,
    /// Whether something that the capture refers to is missing.
    pub is_incomplete: bool,
}

/// Maximum side of a picture that is shown before it has a surface, px.
const MAX_EARLY_PICTURE_PX: u32 = 1000;

/// Passes a picture to `steps`, to be shown while its surface is made.
pub(crate) fn show_early_picture(picture: &Photograph, steps: &dyn Steps) {
    let longer = picture.width.max(picture.height);
    let Photograph { width, height, pixels } = picture.downsampled(longer.div_ceil(MAX_EARLY_PICTURE_PX));
    let coverage = vec![1.0; pixels.len()];
    steps.picture_ready(&Picture { width, height, radiance: pixels, coverage, colour_coverage: None });
}

/// Checks that a picture still has the size that its file had when it was opened.
pub(crate) fn check_size(
    photograph: Photograph,
    size: [u32; 2],
    path: &Path,
) -> Result<Photograph, DocumentError> {
    if [photograph.width, photograph.height] == size {
        return Ok(photograph);
    }
    let message = format!(
        "changed while it was being opened: {} × {} px became {} × {} (open it again)",
        size[0], size[1], photograph.width, photograph.height
    );
    Err(DocumentError::bad_file(path, message))
}

/// The margin by which the surface is continued around the picture, for blur up to this radius, px.
pub(crate) fn margin_px(size: [usize; 2], largest_px: f64) -> usize {
    /// As a share of the shorter side: a wider margin would visibly be invented.
    const MAX_SHARE: f64 = 0.2;
    let max_px = MAX_SHARE * size[0].min(size[1]) as f64;
    largest_px.min(max_px).ceil() as usize
}

/// The least and the greatest finite value; zeros if there is none.
pub(crate) fn finite_range(values: &[f32]) -> [f64; 2] {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    let [low, high] = finite
        .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    if low <= high { [low, high].map(f64::from) } else { [0.0; 2] }
}

/// The focal length if the lens is unknown, px.
pub(crate) fn default_focal_px(size: [u32; 2]) -> f64 {
    0.5 * f64::from(size[0].max(size[1])) / (0.5 * DEFAULT_LONGER_ANGLE).tan()
}

/// The document error for a failed surface.
pub(crate) fn relief_error(error: ReliefError<CaptureError>) -> DocumentError {
    match error {
        ReliefError::Cancelled(_) => DocumentError::Cancelled,
        ReliefError::View(error) => error.into(),
    }
}
