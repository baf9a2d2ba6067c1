//! Exposure, white balance and vignetting of all photographs, from surface points that several of them see.
//!
//! ```text
//! log₂ I(v, c, x) = log₂ D(c, x) + g(v, c) + k₁(l)·r² + k₂(l)·r⁴
//! ```
//!
//! | symbol | meaning | unit |
//! | --- | --- | --- |
//! | I | light that photograph v shows of point x in channel c | its white |
//! | D | light of the point, the same for all that see it | |
//! | g | gain of photograph and channel; its mean over photographs is 0 | stops |
//! | k₁, k₂ | vignetting of lens l | stops |
//! | r | distance from the lens's axis, over half the picture's diagonal | |
//!
//! D falls out: of every point only differences from its weighted mean count (Goldman 2010, without his response curve). Points that gloss
//! or occlusion differ at are left out by Cauchy's weights, their scale the median of what is left over.

mod equations;
mod exposure;
mod said;

pub use exposure::Exposure;

use super::numbers::{median, solve_positive};
use super::places::{Sphere, Texels};
use super::seeing::Sightings;
use equations::System;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use said::{far_points, near_points};
use scene::View;

/// Rounds of reweighting; weights have settled by then.
const ROUNDS: usize = 16;
/// Residuals are thought to be no smaller, stops.
const LEAST_SCALE: f64 = 0.03;
/// What holds a gain that nothing else does (at its hint, or at 0): as much as half a point.
const HOLD: f64 = 0.5;
/// What holds the channels of a photograph together, as points: its white balance is at first thought to be that of all others, so that
/// a colour that is dark in some does not lead them astray.
const HOLD_WHITE_AT_FIRST: f64 = 1e5;
/// And then on.
const HOLD_WHITE: f64 = 100.0;
/// What holds vignetting at 0: as much as so many points one stop off.
const HOLD_VIGNETTING: f64 = 20.0;

/// Finds the exposures of all views.
pub(crate) fn exposures(
    texels: &Texels,
    sightings: &Sightings,
    sphere: &Sphere,
    views: &[View],
    progress: &dyn Progress,
) -> Result<Vec<Exposure>, Cancelled> {
    let lens_of = lenses(views);
    let lens_count = lens_of.iter().max().map_or(0, |most| most + 1);
    let near = near_points(texels, sightings, views);
    let far = far_points(sightings, sphere, views);
    let unknowns = 3 * views.len() + 2 * lens_count;
    let hints = hints(views);
    let mut solution = vec![0.0; unknowns];
    for (view, hint) in hints.iter().enumerate() {
        solution[3 * view..3 * view + 3].fill(hint.unwrap_or(0.0));
    }
    let mut scales = [1.0; 2];
    for round in 0..ROUNDS {
        progress.check()?;
        progress.report(round as f32 / ROUNDS as f32);
        let system = System { unknowns, views: views.len(), lens_of: &lens_of };
        let (mut matrix, mut right) = (vec![0.0; unknowns * unknowns], vec![0.0; unknowns]);
        // What agrees better says more: by the square of its scale.
        let trust = scales.map(|scale: f64| (scales[0].min(scales[1]) / scale).powi(2));
        for ((points, scale), trust) in [&near, &far].into_iter().zip(&mut scales).zip(trust) {
            let parts: Vec<(Vec<f64>, Vec<f64>, Vec<f64>)> =
                points.par_chunks(2048).map(|points| system.of_points(points, &solution, *scale)).collect();
            let mut left_over = Vec::new();
            for (part, part_right, errors) in parts {
                matrix.iter_mut().zip(part).for_each(|(sum, value)| *sum += trust * value);
                right.iter_mut().zip(part_right).for_each(|(sum, value)| *sum += trust * value);
                left_over.extend(errors);
            }
            if let Some(middle) = median(&mut left_over, f64::total_cmp) {
                // Of a normal distribution.
                *scale = (1.4826 * middle).max(LEAST_SCALE);
            }
        }
        let hold_white = if round < ROUNDS / 2 { HOLD_WHITE_AT_FIRST } else { HOLD_WHITE };
        for view in 0..views.len() {
            for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (3 * view + a, 3 * view + b)) {
                matrix[a * unknowns + a] += hold_white;
                matrix[b * unknowns + b] += hold_white;
                matrix[a * unknowns + b] -= hold_white;
                matrix[b * unknowns + a] -= hold_white;
            }
        }
        for unknown in 0..unknowns {
            let is_gain = unknown < 3 * views.len();
            let hold = if is_gain { HOLD } else { HOLD_VIGNETTING };
            matrix[unknown * unknowns + unknown] += hold;
            if is_gain {
                right[unknown] += hold * hints[unknown / 3].unwrap_or(0.0);
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

/// Views with the same lens have the same number.
fn lenses(views: &[View]) -> Vec<usize> {
    let mut known: Vec<&View> = Vec::new();
    let mut numbers = Vec::with_capacity(views.len());
    for view in views {
        numbers.push(known.iter().position(|other| other.lens == view.lens).unwrap_or(known.len()));
        if numbers.last() == Some(&known.len()) {
            known.push(view);
        }
    }
    numbers
}

/// What EXIF says of each view's gain, relative to the mean of those that say anything.
fn hints(views: &[View]) -> Vec<Option<f64>> {
    let said: Vec<f64> =
        views.iter().filter_map(|view| view.exposure_hint).filter(|h| h.is_finite()).collect();
    let mean = said.iter().sum::<f64>() / said.len().max(1) as f64;
    views.iter().map(|view| view.exposure_hint.filter(|h| h.is_finite()).map(|hint| hint - mean)).collect()
}
