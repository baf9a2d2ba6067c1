//! One photograph according to a reconstruction program, before its file has been looked up.

use glam::DMat4;
use lens::{CalibratedLens, CameraError, Distortion, Intrinsics, Projection};

/// A photograph that has a camera.
#[derive(Clone, Debug)]
pub(crate) struct Shot {
    /// The picture's name in the file with the cameras.
    pub name: String,
    /// Its place in the file with the cameras, for messages.
    pub place: String,
    pub lens: ShotLens,
    pub camera_to_world: DMat4,
    /// The name of its mask, if it has one.
    pub mask: Option<String>,
}

/// A lens as far as it is specified.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ShotLens {
    /// Completely.
    Calibrated(CalibratedLens),
    /// Except for the size of the picture.
    OfAnySize {
        focal: Focal,
        /// Where its axis meets the picture, px, across and down; none: in the middle.
        principal_px: [Option<f64>; 2],
        projection: Projection,
        distortion: Distortion,
    },
}

/// The focal length of a lens.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Focal {
    /// px, across and down.
    Pixels([f64; 2]),
    /// By its full horizontal angle of view, rad.
    AngleAcross(f64),
}

impl ShotLens {
    /// Width and height, px, of the pictures that it was calibrated with, if they are known.
    pub fn size_px(&self) -> Option<[u32; 2]> {
        match self {
            Self::Calibrated(lens) => Some(lens.size_px()),
            Self::OfAnySize { .. } => None,
        }
    }

    /// The lens for a picture of `size_px` (width, height), unless it has a size of its own.
    ///
    /// # Errors
    /// A parameter of the lens is out of range.
    pub fn for_size(&self, size_px: [u32; 2]) -> Result<CalibratedLens, CameraError> {
        match *self {
            Self::Calibrated(lens) => Ok(lens),
            Self::OfAnySize { focal, principal_px, projection, distortion } => {
                let [width, height] = size_px.map(f64::from);
                let focal_px = match focal {
                    Focal::Pixels(focal) => focal,
                    Focal::AngleAcross(angle) => [0.5 * width / (0.5 * angle).tan(); 2],
                };
                let [x, y] = principal_px;
                let principal_px = [x.unwrap_or(0.5 * width), y.unwrap_or(0.5 * height)];
                let intrinsics = Intrinsics { size_px, focal_px, skew_px: 0.0, principal_px };
                CalibratedLens::new(intrinsics, projection, distortion)
            }
        }
    }
}

/// The result of reading cameras.
#[derive(Debug, Default)]
pub(crate) struct Shots {
    pub shots: Vec<Shot>,
    /// Sentences about irregularities, without the file.
    pub notes: Vec<String>,
    /// Pictures that are listed without a usable camera.
    pub without_camera: Vec<String>,
}
