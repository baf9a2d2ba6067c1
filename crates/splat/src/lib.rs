//! SALF and focus to picture: the sum of the aperture images, in integers.
//!
//! ```
//! use glam::{Vec2, Vec3};
//! use lens::{Camera, FocusOffset};
//! use progress::Unwatched;
//! use salf::{BakedOn, Carried, Salf, Sample, Visibility};
//! use surface::{SurfaceField, SurfacePoint};
//! use splat::Splatter;
//! use std::sync::Arc;
//!
//! struct Unpainted;
//! impl SurfaceField<FocusOffset> for Unpainted {
//!     fn at(&self, _point: SurfacePoint) -> FocusOffset {
//!         FocusOffset::STANDARD
//!     }
//!     fn at_infinity(&self) -> FocusOffset {
//!         FocusOffset::STANDARD
//!     }
//! }
//!
//! // A background of radiance 1: a sample for every pixel of 16 × 16.
//! let camera = Camera { width: 16, height: 16, ..Camera::default() };
//! let sample = |k: u32| Sample {
//!     center: Vec2::new((k % 16) as f32, (k / 16) as f32) + 0.5,
//!     half_size: Vec2::splat(0.5),
//!     inverse_depth: 1.0 / camera.focus_distance as f32,
//!     weight: 1.0,
//!     tilt: Vec2::ZERO,
//!     radiance: Vec3::ONE,
//!     surface: None,
//!     is_carried: false,
//!     visibility: Visibility::Open,
//! };
//! let samples = (0..256).map(sample).collect();
//! let baked_on = BakedOn::Processor;
//! let salf = Salf { camera: camera.clone(), margin_px: 0, carried: Carried::Standard, baked_on, samples };
//!
//! let mut splatter = Splatter::new(Arc::new(salf)); // once per bake
//! splatter.render(&camera, &Unpainted, &Unwatched)?; // the whole picture: at first, and for another lens
//! let window = splatter.update(&Unpainted, &[7])?; // after painting: subtract and add
//! assert_eq!(window.map(|range| range.start), [0, 0]);
//! assert!((splatter.picture().coverage[100] - 1.0).abs() < 1e-3);
//! # Ok::<(), splat::SplatError>(())
//! ```
//!
//! Samples form a hierarchy ([`salf::tree`]), which is converted to integers once (`nodes`). A lens (`lens_in_use`) and paint
//! (`paint`) give each node its defocus κ and thereby decide which nodes are drawn (`draw_list`): a sample itself where it is
//! nearly in focus, one node for many where they are far out of focus. A node is drawn as the image of the aperture (`draw`),
//! of rows that were cut once for all splats of its size (`aperture`), on the level of a pyramid of accumulators whose pixels
//! are about its own size (`canvas`, `sums`). Running sums and upsampling make the picture (`resolve`): partly occluded samples
//! share what open ones leave of a pixel (`resolve::partition`), and the sum of light is preserved (`resolve::balance`).
//! `gpu` does the same on a graphics card, bit for bit.
//!
//! A picture that is too large for memory is summed in crops ([`CropSums`]), from a light field in parts.

#![cfg_attr(
    not(feature = "gpu"),
    allow(dead_code, unused_imports, reason = "what only sums on a graphics card use")
)]

mod aperture;
mod bands;
mod canvas;
mod character;
mod crop;
mod draw;
mod draw_list;
mod fixed;
#[cfg(feature = "gpu")]
mod gpu;
mod lens_in_use;
mod node_view;
mod nodes;
mod paint;
mod resolve;
mod splatter;
mod sums;

pub use crop::{
    Crop, CropError, CropFacts, CropForm, CropJoiner, CropOptions, CropPicture, CropRow, CropSums, Integers,
    KNOT_NUMBERS, Kind,
};
#[cfg(feature = "gpu")]
pub use gpu::PictureOnCard;
pub use lens_in_use::Tolerance;
pub use nodes::QUANTUM;
pub use splatter::{Mattes, SETS, SplatError, Splatter, WideImage};
