//! The surface-aperture light field (SALF): for a fixed camera, the image of the aperture as seen from each surface point.
//!
//! [`bake()`] samples every surface that is visible from some point of the aperture. Samples come from the pinhole picture
//! where surfaces face the aperture (their footprints are the squares of the pixel grid or quadrants of them, so that they
//! tile the picture exactly), and from the surface itself where it is edge-on, or small and bright. A [`Sample`] has a surface
//! address, a weight toward every aperture point, a radiance, and the visible part of the aperture ([`Visibility`]). Samples
//! are stored packed ([`Samples`]). [`tree`] joins them to nodes for defocused regions; [`SalfFile`] is the file.
//!
//! ```
//! use glam::{Vec2, Vec3};
//! use salf::{BakedOn, Carried, Salf, Sample, Visibility};
//!
//! let sample = Sample {
//!     center: Vec2::splat(0.5),
//!     half_size: Vec2::splat(0.5),
//!     inverse_depth: 0.25,
//!     weight: 1.0,
//!     tilt: Vec2::ZERO,
//!     radiance: Vec3::ONE,
//!     surface: None,
//!     is_carried: false,
//!     visibility: Visibility::from_words(&[0x00FF_FFFF_FFFF_FFFF]),
//! };
//! let samples = [sample].into_iter().collect();
//! let (camera, baked_on) = (lens::Camera::default(), BakedOn::Processor);
//! let salf = Salf { camera, margin_px: 0, carried: Carried::Standard, baked_on, samples };
//! assert_eq!((salf.statistics().open, salf.statistics().partial), (0, 1));
//! ```

#![cfg_attr(not(feature = "bake"), allow(dead_code, unused_imports, reason = "what only baking uses"))]

#[cfg(feature = "bake")]
mod baker;
mod carried;
mod domain;
mod file;
mod jitter;
mod light_change;
#[cfg(feature = "bake")]
mod margin;
#[cfg(feature = "bake")]
mod options;
mod salf;
mod sample;
mod samples;
pub mod tree;
#[cfg(feature = "bake")]
mod view;

#[cfg(feature = "bake")]
pub use baker::outliers::Outliers;
#[cfg(feature = "bake")]
pub use baker::parts::{PartsBaker, Surroundings};
#[cfg(feature = "bake")]
pub use baker::{bake, bake_on};
pub use carried::Carried;
pub use domain::{Cell, Domain};
pub use file::{SalfFile, SalfFileError};
pub use light_change::LightChange;
#[cfg(feature = "bake")]
pub use margin::LARGEST_MARGIN_HEIGHTS;
#[cfg(feature = "bake")]
pub use options::BakeOptions;
pub use salf::{BakedOn, Salf, SalfStatistics};
pub use sample::{Address, Sample, SampleFocus, Visibility};
pub use samples::{Addresses, Run, SampleLocation, Samples};
