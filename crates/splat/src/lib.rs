//! SALF and focus to picture: the sum of the aperture images, in integers.
//!
//! ```text
//! let mut splatter = Splatter::new(salf);             // once a bake
//! splatter.render(&camera, &focus, progress)?;        // the whole picture: first, or the lens has changed
//! let rows = splatter.update(&focus, &changed)?;      // painted: subtract and add
//! let picture = splatter.picture();
//! ```
//!
//! A [`salf::Sample`] with the defocus κ throws an aperture image ([`aperture_image`]): pieces of the aperture
//! ([`kernel`]) scaled by κ, each a rectangle blurred by the sample's footprint ([`trapezoid`]), written as differences
//! along pixel rows ([`accumulator`]) in fixed point ([`fixed_point`]). Partly occluded samples share what open ones leave
//! ([`partition`]).

mod accumulator;
mod aperture_image;
mod fixed_point;
mod kernel;
mod lens_in_use;
mod partition;
mod splatter;
mod sums;
mod trapezoid;

pub use splatter::{SplatError, Splatter};
