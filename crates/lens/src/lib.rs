//! The camera and its optics.
//!
//! All of focusing is one signed number a point, the *defocus* κ (see [`Optics::kappa`]); every other crate
//! takes κ and the landing point q from here, so that splat, ground truth and tests share one formula.
//!
//! * [`Camera`]: what is saved: resolution, field of view, focus distance, aperture, pose.
//! * [`Optics`]: the same, reduced to the numbers of the formula, for inner loops.
//! * [`FocusOffset`]: what is painted: t, its anchor a, and how far gloss obeys them.
//! * [`Aperture`]: its shape, how to sample it and how to cut it into rows.
//! * [`Character`]: what a lens does beside focusing: cat's eye, edges, colour fringes, field curvature.
//! * [`CalibratedLens`]: what of a real camera calibration found: direction ↔ pixel of its photographs, distortion included.
//! * [`Picture`]: what comes out: radiance and coverage a pixel, and the two exposures.
//!
//! Camera space: aperture centre at the origin, x right, y up, z forward (depth, > 0 in front). f64
//! throughout, lengths in scene units (metres in glTF).
//!
//! # Example
//!
//! ```
//! use lens::{Camera, FocusOffset};
//!
//! let optics = Camera { focus_distance: 2.0, ..Camera::default() }.optics();
//! assert_eq!(optics.kappa(1.0 / 2.0, FocusOffset::STANDARD), 0.0); // in the plane of focus
//! assert!(optics.kappa(1.0 / 8.0, FocusOffset::STANDARD) > 0.0); // far defocus
//! assert_eq!(optics.kappa(1.0 / 8.0, FocusOffset::SHARP), 0.0); // painted sharp
//! ```

mod aperture;
pub mod blur_scale;
mod calibrated_lens;
mod camera;
mod character;
mod coarse_mask;
mod error;
mod focus_offset;
mod optics;
mod picture;
mod sub_aperture;

pub use aperture::{Aperture, ApertureMask, ApertureRow, ApertureRows, ApertureSampler, ApertureShape, Run};
pub use calibrated_lens::{CalibratedLens, Distortion, Intrinsics, Projection};
pub use camera::Camera;
pub use character::{
    CHANNELS, Character, CharacterOptics, Edges, FULL_EDGE, Falloff, GREEN, Rim, RimLimit, Vignette,
    Vignetting,
};
pub use error::CameraError;
pub use focus_offset::FocusOffset;
pub use optics::Optics;
pub use picture::{Exposure, Picture};
pub use sub_aperture::SUB_APERTURE_RADIUS;
