//! Fitting of the radiance model of each texel.
//!
//! ```text
//! calibrated observations ─▶ constant ─▶ mirrored ─▶ residuals ─▶ RadianceModel
//!                                └▶ hole_filling       └ directional_regression
//! ```
//!
//! `radiance_model` runs these steps, `one_view` makes the plain texture used as a baseline; `background` fits the
//! light from infinity, `reflection` computes mirrored directions and their occlusion.

mod background;
mod calibrated;
mod directional_regression;
mod hole_filling;
mod mirrored;
mod one_view;
mod radiance_model;
mod reflection;
mod residuals;
mod robust_averaging;

pub(crate) use background::fit_background;
pub(crate) use calibrated::CalibratedObservations;
pub(crate) use directional_regression::{Kernel, ResidualSample, direction_to_eye};
pub(crate) use hole_filling::fill_unobserved;
pub(crate) use mirrored::Mirrored;
pub(crate) use one_view::fit_single_view;
pub(crate) use radiance_model::{FULL_EVIDENCE, RadianceModel, fit_radiance_model};
pub(crate) use reflection::is_reflection_blocked;
pub(crate) use residuals::{CrossValidation, MIN_ERROR, Residuals, Workspace};
pub(crate) use robust_averaging::{Sample, robust_mean, roots};
