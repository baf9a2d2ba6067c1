//! Whether photographs are told better by the others once they are aligned: at texels that they were not aligned by.

use super::halves::{Fold, fold_of};
use super::lattice::Displacement;
use crate::photographs::exposures::Exposure;
use crate::photographs::odd;
use crate::photographs::places::TexelBlocks;
use crate::photographs::telling::{
    CalibratedObservations, ResidualSample, Workspace, direction_to_eye, robust_mean,
};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::View;

/// Texels that are asked for each photograph, about.
const TEXELS_PER_VIEW: usize = 3_000;
/// A texel that fewer photographs see says nothing.
const MIN_VIEWS: usize = 4;
/// What is off by more (radiance) is something else.
const MAX_ERROR: f32 = 0.25;
/// A photograph is aligned if that takes so much of what the others tell wrong of it.
const MIN_IMPROVEMENT: f64 = 0.04;
/// Photographs that are not aligned change what the others are compared with: so often.
const ROUNDS: usize = 3;

/// What the others tell wrong of each photograph, summed, weighted.
fn prediction_errors(
    radiance: &CalibratedObservations<'_>,
    views: &[View],
    exposures: &[Exposure],
    displacements: &[Displacement],
    texels: &[usize],
) -> Vec<f64> {
    let texel_errors = |work: &mut Workspace, &texel: &usize| -> Vec<(u16, f32)> {
        let observations = radiance.observations.of_texel(texel);
        let from = radiance.texels.position(texel);
        radiance.collect_samples(texel, &mut work.samples);
        for (sample, observation) in work.samples.iter_mut().zip(observations) {
            let number = usize::from(observation.view);
            if !displacements[number].is_none()
                && let Some(pixel) = views[number].project(from)
            {
                let picture = &radiance.observations.pictures[number];
                let shown = picture.at(picture.place(displacements[number].moved(pixel)));
                sample.light = shown.light * exposures[number].to_radiance(&views[number], pixel);
            }
        }
        let constant = robust_mean(&work.samples, &mut Vec::new());
        work.residuals.clear();
        for (index, (sample, observation)) in work.samples.iter().zip(observations).enumerate() {
            let direction = direction_to_eye(from, radiance.eye(observation));
            let weight = sample.weight_against(constant);
            work.residuals.push(ResidualSample { index, direction, value: sample.light - constant, weight });
        }
        work.retain_best();
        work.leave_one_out(&odd::PREDICTION_KERNEL);
        let errors = work.residuals.iter().zip(work.errors()).map(|(residual, error)| {
            (observations[residual.index].view, residual.weight * error.length().min(MAX_ERROR))
        });
        errors.collect()
    };
    let errors_by_texel: Vec<Vec<(u16, f32)>> =
        texels.par_iter().map_init(Workspace::new, texel_errors).collect();
    let mut sums = vec![0.0; views.len()];
    for (view, error) in errors_by_texel.into_iter().flatten() {
        sums[usize::from(view)] += f64::from(error);
    }
    sums
}

/// Those of the displacements that lower the errors, the others none.
pub(super) fn retain_improvements(
    radiance: &CalibratedObservations<'_>,
    views: &[View],
    exposures: &[Exposure],
    mut displacements: Vec<Displacement>,
    progress: &dyn Progress,
) -> Result<Vec<Displacement>, Cancelled> {
    if displacements.iter().all(Displacement::is_none) {
        return Ok(displacements);
    }
    let none: Vec<Displacement> = views.iter().map(Displacement::none).collect();
    let blocks = TexelBlocks::new(radiance.texels.size());
    let is_validation = |texel: &usize| {
        radiance.observations.range(*texel).len() >= MIN_VIEWS
            && fold_of(&blocks, radiance.texels, *texel) == Fold::Validation
    };
    let texels: Vec<usize> = (0..radiance.texels.count()).filter(is_validation).collect();
    let count: usize = texels.iter().map(|&texel| radiance.observations.range(texel).len()).sum();
    let step = count.div_ceil(TEXELS_PER_VIEW * views.len()).max(1);
    let texels: Vec<usize> = texels.into_iter().step_by(step).collect();
    let before = prediction_errors(radiance, views, exposures, &none, &texels);
    for _ in 0..ROUNDS {
        progress.check()?;
        let after = prediction_errors(radiance, views, exposures, &displacements, &texels);
        let mut is_changed = false;
        for (view, none) in none.iter().enumerate() {
            let is_improved = after[view] < (1.0 - MIN_IMPROVEMENT) * before[view];
            if !displacements[view].is_none() && !is_improved {
                displacements[view] = none.clone();
                is_changed = true;
            }
        }
        if !is_changed || displacements.iter().all(Displacement::is_none) {
            return Ok(displacements);
        }
    }
    // What still changes is told by nobody for sure.
    let after = prediction_errors(radiance, views, exposures, &displacements, &texels);
    let is_improved = after.iter().sum::<f64>() < (1.0 - MIN_IMPROVEMENT) * before.iter().sum::<f64>();
    Ok(if is_improved { displacements } else { none })
}
