//! Exposure, white balance and vignetting of all photographs, from surface points that several of them observe.
//!
//! ```text
//! log₂ I(v, c, x) = log₂ D(c, x) + g(v, c) + k₁(l)·r² + k₂(l)·r⁴
//! ```
//!
//! | symbol | meaning | unit |
//! | --- | --- | --- |
//! | I | light that photograph v shows of point x in channel c | its white |
//! | D | light of the point, the same for all that observe it | |
//! | g | gain of photograph and channel; its mean over photographs is 0 | stops |
//! | k₁, k₂ | vignetting of lens l | stops |
//! | r | distance from the lens's axis, over half the picture's diagonal | |
//!
//! D is eliminated: for every point only differences from its weighted mean count (Goldman 2010, without his response
//! curve). Points with gloss or occlusion are down-weighted by Cauchy weights whose scale is the median residual.

mod equations;
mod exposure;
mod exposure_observations;

pub use exposure::Exposure;

use super::observations::Observations;
use super::texels::{DirectionGrid, Texels};
use equations::NormalEquations;
use exposure_observations::{background_points, surface_points};
use numerics::{scaled_mad, solve_positive};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::View;

/// Rounds of reweighting, after which the weights have converged.
const ROUNDS: usize = 16;
/// Lower bound of the residual scale, stops.
const MIN_SCALE_STOPS: f64 = 0.03;
/// Prior weight that keeps a gain at its hint, or at 0: as much as half a point.
const PRIOR_WEIGHT: f64 = 0.5;
/// Prior weight, in points, that keeps the channels of a photograph together in the first rounds. Starting from a
/// common white balance prevents colours that are dark in some photographs from leading them astray.
const INITIAL_WHITE_WEIGHT: f64 = 1e5;
/// The same in later rounds.
const WHITE_WEIGHT: f64 = 100.0;
/// Prior weight that keeps vignetting at 0: as much as this many points that are one stop off.
const VIGNETTING_WEIGHT: f64 = 20.0;

/// Solves for the exposures of all views.
///
/// # Errors
/// [`Cancelled`] if `progress` asks to stop.
pub(crate) fn solve_exposures(
    texels: &Texels,
    observations: &Observations,
    sphere: &DirectionGrid,
    views: &[View],
    progress: &dyn Progress,
) -> Result<Vec<Exposure>, Cancelled> {
    let lens_of = lens_indices(views);
    let lens_count = lens_of.iter().max().map_or(0, |max| max + 1);
    let surface = surface_points(texels, observations, views);
    let background = background_points(observations, sphere, views);
    let unknowns = 3 * views.len() + 2 * lens_count;
    let hints = relative_hints(views);
    let mut solution = vec![0.0; unknowns];
    for (view, hint) in hints.iter().enumerate() {
        solution[3 * view..3 * view + 3].fill(hint.unwrap_or(0.0));
    }
    let mut scales = [1.0; 2];
    for round in 0..ROUNDS {
        progress.check()?;
        progress.report(round as f32 / ROUNDS as f32);
        let system = NormalEquations { unknowns, views: views.len(), lens_of: &lens_of };
        let (mut matrix, mut right) = (vec![0.0; unknowns * unknowns], vec![0.0; unknowns]);
        // Points that agree better count more: by the inverse square of their scale.
        let trust = scales.map(|scale: f64| (scales[0].min(scales[1]) / scale).powi(2));
        for ((points, scale), trust) in [&surface, &background].into_iter().zip(&mut scales).zip(trust) {
            let parts: Vec<(Vec<f64>, Vec<f64>, Vec<f64>)> =
                points.par_chunks(2048).map(|points| system.accumulate(points, &solution, *scale)).collect();
            let mut residuals = Vec::new();
            for (part, part_right, errors) in parts {
                matrix.iter_mut().zip(part).for_each(|(sum, value)| *sum += trust * value);
                right.iter_mut().zip(part_right).for_each(|(sum, value)| *sum += trust * value);
                residuals.extend(errors);
            }
            if let Some(deviation) = scaled_mad(&mut residuals) {
                // Factor for a normal distribution.
                *scale = deviation.max(MIN_SCALE_STOPS);
            }
        }
        let white_weight = if round < ROUNDS / 2 { INITIAL_WHITE_WEIGHT } else { WHITE_WEIGHT };
        for view in 0..views.len() {
            for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (3 * view + a, 3 * view + b)) {
                matrix[a * unknowns + a] += white_weight;
                matrix[b * unknowns + b] += white_weight;
                matrix[a * unknowns + b] -= white_weight;
                matrix[b * unknowns + a] -= white_weight;
            }
        }
        for unknown in 0..unknowns {
            let is_gain = unknown < 3 * views.len();
            let prior_weight = if is_gain { PRIOR_WEIGHT } else { VIGNETTING_WEIGHT };
            matrix[unknown * unknowns + unknown] += prior_weight;
            if is_gain {
                right[unknown] += prior_weight * hints[unknown / 3].unwrap_or(0.0);
            }
        }
        solve_positive(&mut matrix, &mut right);
        solution = right;
    }
    let mean = |channel: usize| {
        (0..views.len()).map(|view| solution[3 * view + channel]).sum::<f64>() / views.len().max(1) as f64
    };
    let mean = [mean(0), mean(1), mean(2)];
    Ok((0..views.len())
        .map(|view| Exposure {
            gain_stops: std::array::from_fn(|channel| solution[3 * view + channel] - mean[channel]),
            vignetting_stops: std::array::from_fn(|k| solution[3 * views.len() + 2 * lens_of[view] + k]),
        })
        .collect())
}

/// By view: the number of its lens; equal lenses share a number.
fn lens_indices(views: &[View]) -> Vec<usize> {
    let mut unique_lenses: Vec<&View> = Vec::new();
    let mut numbers = Vec::with_capacity(views.len());
    for view in views {
        numbers.push(
            unique_lenses.iter().position(|other| other.lens == view.lens).unwrap_or(unique_lenses.len()),
        );
        if numbers.last() == Some(&unique_lenses.len()) {
            unique_lenses.push(view);
        }
    }
    numbers
}

/// EXIF gains of the views, stops, relative to the mean of those that have one.
fn relative_hints(views: &[View]) -> Vec<Option<f64>> {
    let finite_hints: Vec<f64> =
        views.iter().filter_map(|view| view.exposure_hint).filter(|h| h.is_finite()).collect();
    let mean = finite_hints.iter().sum::<f64>() / finite_hints.len().max(1) as f64;
    views.iter().map(|view| view.exposure_hint.filter(|h| h.is_finite()).map(|hint| hint - mean)).collect()
}
