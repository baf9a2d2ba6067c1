//! Alignment of photographs that are a few pixels off because of errors in poses or surface.
//!
//! ```text
//! observations ─▶ points ─▶ predictions by the other photographs ─▶ gauss_newton (one step of each lattice) ─▶ validation ─▶ Displacement
//!                               └────────── repeated, from coarse pictures to fine ──────────┘
//! ```
//!
//! A photograph is expected to show of a surface point what the others show of it, with exposures undone. It is warped
//! by a lattice of displacements until it does (`gauss_newton`); all photographs are updated in turn from each other's
//! predictions. Held-out points are then compared (`validation`): a photograph that the others predict no better than
//! before stays unchanged.

mod folds;
mod gauss_newton;
mod lattice;
mod points;
mod validation;

pub(crate) use lattice::Displacement;

use super::exposures::Exposure;
use super::fitting::CalibratedObservations;
use super::observations::PackedPicture;
use super::transients::InlierMap;
use points::ComparisonPoints;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::View;

/// Number of passes over all photographs at a quarter, half and full resolution. A displacement of a few pixels is less
/// than two at the coarsest level.
const PASSES_PER_LEVEL: [usize; 3] = [4, 3, 2];
/// Photographs displaced by less than this everywhere, px as stored, are left unchanged.
const MIN_DISPLACEMENT_PX: f64 = 0.1;

/// The displacement of each view, kept only where it lowers the error of predictions by the other views.
///
/// # Errors
/// [`Cancelled`] if `progress` asks to stop.
pub(crate) fn align_photographs(
    calibrated: &CalibratedObservations<'_>,
    views: &[View],
    exposures: &[Exposure],
    inlier_maps: &[InlierMap],
    progress: &dyn Progress,
) -> Result<Vec<Displacement>, Cancelled> {
    let zeros: Vec<Displacement> = views.iter().map(Displacement::none).collect();
    let points = ComparisonPoints::new(calibrated, views, exposures, inlier_maps);
    let pictures = &calibrated.observations.pictures;
    let mut current = zeros.clone();
    let passes: usize = PASSES_PER_LEVEL.iter().sum();
    let mut done = 0;
    let half = halved_pictures(pictures);
    let quarter = halved_pictures(&half);
    for (pictures, passes_of_level) in [&quarter[..], &half, pictures].into_iter().zip(PASSES_PER_LEVEL) {
        for _ in 0..passes_of_level {
            progress.check()?;
            let predictions = points.predict(pictures, &current);
            let refined = |(view_index, before): (usize, &Displacement)| {
                let comparisons = points.compare(view_index, &pictures[view_index], before, &predictions);
                let reduction = calibrated.observations.pictures[view_index].reduction;
                gauss_newton::refine_displacement(&views[view_index], before, &comparisons, reduction)
                    .unwrap_or_else(|| before.clone())
            };
            current = current.par_iter().enumerate().map(refined).collect();
            done += 1;
            progress.report(0.8 * done as f32 / passes as f32);
        }
    }
    drop([half, quarter]);
    for ((displacement, zero), picture) in current.iter_mut().zip(zeros).zip(pictures) {
        if displacement.max_px() < MIN_DISPLACEMENT_PX * f64::from(picture.reduction) {
            *displacement = zero;
        }
    }
    let aligned = validation::retain_improvements(calibrated, views, exposures, current, progress)?;
    progress.report(1.0);
    Ok(aligned)
}

/// Pictures at half the resolution.
fn halved_pictures(pictures: &[PackedPicture]) -> Vec<PackedPicture> {
    pictures.par_iter().map(PackedPicture::halved).collect()
}
