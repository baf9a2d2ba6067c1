//! What a reconstruction program says of one photograph, before its file has been looked for.

use glam::DMat4;
use lens::{CalibratedLens, CameraError, Distortion, Intrinsics, Projection};

/// A photograph that has a camera.
#[derive(Clone, Debug)]
pub(crate) struct Shot {
    /// What the file with the cameras calls the picture.
    pub name: String,
    /// Where the file with the cameras tells of it, for messages.
    pub place: String,
    pub lens: ShotLens,
    pub camera_to_world: DMat4,
    /// What it calls its mask, if it has one.
    pub mask: Option<String>,
}

/// A lens as far as it is told.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ShotLens {
    /// In all.
    Calibrated(CalibratedLens),
    /// But for the size of the picture, in whose middle its axis is.
    Centred { focal: Focal, projection: Projection, distortion: Distortion },
}

/// How long a lens is.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Focal {
    /// px.
    Pixels(f64),
    /// By its full angle of view across, rad.
    AngleAcross(f64),
}

impl ShotLens {
    /// The size of the pictures that it was found with, if it knows.
    pub fn size_px(&self) -> Option<[u32; 2]> {
        match self {
            Self::Calibrated(lens) => Some(lens.size_px()),
            Self::Centred { .. } => None,
        }
    }

    /// The lens of a picture of this size, if it does not know better.
    pub fn for_size(&self, size_px: [u32; 2]) -> Result<CalibratedLens, CameraError> {
        match *self {
            Self::Calibrated(lens) => Ok(lens),
            Self::Centred { focal, projection, distortion } => {
                let [width, height] = size_px.map(f64::from);
                let focal = match focal {
                    Focal::Pixels(focal) => focal,
                    Focal::AngleAcross(angle) => 0.5 * width / (0.5 * angle).tan(),
                };
                let principal_px = [0.5 * width, 0.5 * height];
                let intrinsics = Intrinsics { size_px, focal_px: [focal; 2], skew_px: 0.0, principal_px };
                CalibratedLens::new(intrinsics, projection, distortion)
            }
        }
    }
}

/// What a reader of cameras gives.
#[derive(Debug, Default)]
pub(crate) struct Shots {
    pub shots: Vec<Shot>,
    /// Sentences about what was odd, without the file.
    pub notes: Vec<String>,
    /// Pictures that are listed without a camera that can be used, and why.
    pub without_camera: Vec<String>,
}
