//! A cloud of splats, as it is kept in memory.

mod axes;
mod builder;
mod gaussian_cloud;
pub mod harmonics;
mod harmonics_rotation;
mod left_out;
mod morton_order;
mod sparse_points;
mod splat;
mod srgb;

pub use axes::{Axes, Toward};
pub use builder::CloudBuilder;
pub use gaussian_cloud::{CloudTraits, ColorSpace, GaussianCloud};
pub use harmonics_rotation::HarmonicsRotation;
pub use left_out::{LeftOut, Reason};
pub use sparse_points::have_neighbors;
pub use splat::Splat;
pub use srgb::{linear_to_srgb, srgb_to_linear};
