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

pub(crate) use beyond::fit_background;
pub(crate) use calibrated::CalibratedObservations;
pub(crate) use constant::{Sample, robust_mean, roots};
pub(crate) use directions::{Kernel, ResidualSample, direction_to_eye};
pub(crate) use filling::fill_unobserved;
pub(crate) use mirrored::Mirrored;
pub(crate) use one_view::fit_single_view;
pub(crate) use reflection::is_reflection_blocked;
pub(crate) use residuals::{CrossValidation, MIN_ERROR, Residuals, Workspace};
pub(crate) use told::{FULL_EVIDENCE, RadianceModel, fit_radiance_model};
