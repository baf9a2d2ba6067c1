//! Validation of the alignment: whether the others predict a photograph better once it is aligned, at texels not used
//! for fitting.

use super::folds::{Fold, fold_of};
use super::lattice::Displacement;
use crate::photographs::exposures::Exposure;
use crate::photographs::fitting::{
    CalibratedObservations, ResidualSample, Workspace, direction_to_eye, robust_mean,
};
use crate::photographs::texels::TexelBlocks;
use crate::photographs::transients;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::View;

/// Approximate number of texels compared per photograph.
const TEXELS_PER_VIEW: usize = 3_000;
/// Texels observed by fewer photographs are skipped.
const MIN_VIEWS: usize = 4;
/// Upper bound of an error (radiance): larger differences have other causes.
const MAX_ERROR: f32 = 0.25;
/// A photograph is aligned if that lowers its prediction error by at least this share.
const MIN_IMPROVEMENT: f64 = 0.04;
/// Resetting a photograph changes what the others are compared with: maximum number of rounds.
const ROUNDS: usize = 3;

/// Weighted sum of the prediction errors of each photograph.
fn prediction_errors(
    calibrated: &CalibratedObservations<'_>,
    views: &[View],
    exposures: &[Exposure],
    displacements: &[Displacement],
    texels: &[usize],
) -> Vec<f64> {
    let texel_errors = |workspace: &mut Workspace, &texel: &usize| -> Vec<(u16, f32)> {
        let observations = calibrated.observations.of_texel(texel);
        let from = calibrated.texels.position(texel);
        calibrated.collect_samples(texel, &mut workspace.samples);
        for (sample, observation) in workspace.samples.iter_mut().zip(observations) {
            let view_index = usize::from(observation.view);
            if !displacements[view_index].is_none()
                && let Some(pixel) = views[view_index].project(from)
            {
                let picture = &calibrated.observations.pictures[view_index];
                let shown = picture.at(picture.place(displacements[view_index].moved(pixel)));
                sample.light = shown.light * exposures[view_index].to_radiance(&views[view_index], pixel);
            }
        }
        let constant = robust_mean(&workspace.samples, &mut Vec::new());
        workspace.residuals.clear();
        for (index, (sample, observation)) in workspace.samples.iter().zip(observations).enumerate() {
            let direction = direction_to_eye(from, calibrated.eye(observation));
            let weight = sample.weight_against(constant);
            workspace.residuals.push(ResidualSample {
                index,
                direction,
                value: sample.light - constant,
                weight,
            });
        }
        workspace.retain_best();
        workspace.leave_one_out(&transients::PREDICTION_KERNEL);
        let errors = workspace.residuals.iter().zip(workspace.errors()).map(|(residual, error)| {
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

/// Retains the displacements that lower the prediction errors and resets the others.
pub(super) fn retain_improvements(
    calibrated: &CalibratedObservations<'_>,
    views: &[View],
    exposures: &[Exposure],
    mut displacements: Vec<Displacement>,
    progress: &dyn Progress,
) -> Result<Vec<Displacement>, Cancelled> {
    if displacements.iter().all(Displacement::is_none) {
        return Ok(displacements);
    }
    let zeros: Vec<Displacement> = views.iter().map(Displacement::none).collect();
    let blocks = TexelBlocks::new(calibrated.texels.size());
    let is_validation = |texel: &usize| {
        calibrated.observations.range(*texel).len() >= MIN_VIEWS
            && fold_of(&blocks, calibrated.texels, *texel) == Fold::Validation
    };
    let texels: Vec<usize> = (0..calibrated.texels.count()).filter(is_validation).collect();
    let count: usize = texels.iter().map(|&texel| calibrated.observations.range(texel).len()).sum();
    let step = count.div_ceil(TEXELS_PER_VIEW * views.len()).max(1);
    let texels: Vec<usize> = texels.into_iter().step_by(step).collect();
    let before = prediction_errors(calibrated, views, exposures, &zeros, &texels);
    for _ in 0..ROUNDS {
        progress.check()?;
        let after = prediction_errors(calibrated, views, exposures, &displacements, &texels);
        let mut is_changed = false;
        for (view, zero) in zeros.iter().enumerate() {
            let is_improved = after[view] < (1.0 - MIN_IMPROVEMENT) * before[view];
            if !displacements[view].is_none() && !is_improved {
                displacements[view] = zero.clone();
                is_changed = true;
            }
        }
        if !is_changed || displacements.iter().all(Displacement::is_none) {
            return Ok(displacements);
        }
    }
    // Not converged: decide for all photographs at once.
    let after = prediction_errors(calibrated, views, exposures, &displacements, &texels);
    let is_improved = after.iter().sum::<f64>() < (1.0 - MIN_IMPROVEMENT) * before.iter().sum::<f64>();
    Ok(if is_improved { displacements } else { zeros })
}
