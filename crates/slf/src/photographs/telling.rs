//! What the light of each texel is told by.
//!
//! ```text
//! calibrated sightings ─▶ constant ─▶ mirrored ─▶ residuals ─▶ Told
//!                            └▶ filling               └ directions
//! ```
//!
//! `told` has them in this order, `one_view` the plain texture to compare with; `beyond` tells the light from infinity,
//! `reflection` what a surface mirrors and what is in its way.

mod beyond;
mod calibrated;
mod constant;
mod directions;
mod filling;
mod mirrored;
mod one_view;
mod reflection;
mod residuals;
mod told;

pub(crate) use beyond::beyond;
pub(crate) use calibrated::Calibrated;
pub(crate) use constant::{Sample, robust_mean, roots};
pub(crate) use directions::{Kernel, Known, toward};
pub(crate) use filling::fill;
pub(crate) use mirrored::Mirrored;
pub(crate) use one_view::one_view;
pub(crate) use reflection::is_blocked;
pub(crate) use residuals::{Believed, LEAST_ERROR, Residuals, Work};
pub(crate) use told::{SEEN, Told, told};
