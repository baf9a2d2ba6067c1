//! Why a baseline could not make its picture.

use crate::FirstHits;
use lens::{Camera, CameraError};
use progress::Cancelled;

/// Why a baseline could not make its picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BaselineError {
    /// The progress was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// A field of the camera is unusable.
    #[error("{0}")]
    Camera(CameraError),
    /// An option is out of its range.
    #[error("{option} must be {must}")]
    Option {
        /// The option.
        option: &'static str,
        /// What it must be.
        must: &'static str,
    },
    /// The pinhole picture, or the light field, is of another camera.
    #[error("made for {actual:?} px, the camera has {camera:?} (make it again for this camera)")]
    OtherCamera {
        /// Columns and rows of what was given.
        actual: [u32; 2],
        /// Columns and rows of the camera.
        camera: [u32; 2],
    },
    /// The aperture is too thin to let any light through.
    #[error("the aperture has no area (take another shape or ratio)")]
    ClosedAperture,
}

impl From<Cancelled> for BaselineError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<CameraError> for BaselineError {
    fn from(error: CameraError) -> Self {
        Self::Camera(error)
    }
}

/// An error unless `value` is in `range`.
pub(crate) fn check_option(
    option: &'static str,
    value: u32,
    range: std::ops::RangeInclusive<u32>,
    must: &'static str,
) -> Result<(), BaselineError> {
    if range.contains(&value) { Ok(()) } else { Err(BaselineError::Option { option, must }) }
}

/// An error unless the camera is usable, and `hits` have its size.
pub(crate) fn check_hits(hits: &FirstHits, camera: &Camera) -> Result<(), BaselineError> {
    camera.validate()?;
    check_size([hits.width, hits.height], camera)?;
    let pixels = hits.width as usize * hits.height as usize;
    let complete = [hits.radiance.len(), hits.depth.len(), hits.focus.len(), hits.kappa.len()];
    if complete == [pixels; 4] {
        Ok(())
    } else {
        Err(BaselineError::Option { option: "first hits", must: "complete, a value a pixel" })
    }
}

/// Checks that a size of `actual` pixels is the camera's.
pub(crate) fn check_size(actual: [u32; 2], camera: &Camera) -> Result<(), BaselineError> {
    let camera = [camera.width, camera.height];
    if actual == camera { Ok(()) } else { Err(BaselineError::OtherCamera { actual, camera }) }
}
