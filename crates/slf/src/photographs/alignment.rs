//! Photographs aligned by the few pixels that their poses, and the surface, are off.
//!
//! ```text
//! sightings ─▶ points ─▶ what others lead to expect ─▶ fitting (a step of each photograph's lattice) ─▶ judging ─▶ Displacement
//!                                └────────── again, from coarse pictures to fine ──────────┘
//! ```
//!
//! What a photograph shows of a surface point is expected to be what the others show of it, in light whose exposures are undone; it is moved
//! by a lattice of displacements until it is (`fitting`), all photographs in turn with what they tell each other. Then what they show of
//! points that were not asked is compared (`judging`): a photograph whose others tell it no better than before stays as it was.

mod fitting;
mod halves;
mod judging;
mod lattice;
mod points;

pub(crate) use lattice::Displacement;

use super::exposures::Exposure;
use super::odd::InlierMap;
use super::seeing::PackedPicture;
use super::telling::CalibratedObservations;
use points::ComparisonPoints;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::View;

/// How often all photographs are moved by what pictures of a quarter, half and all of their pixels each way show. What is a few pixels off is
/// less than two of the coarsest.
const PASSES_PER_LEVEL: [usize; 3] = [4, 3, 2];
/// Photographs that are nowhere off by so much, px as they are kept, are not off.
const MIN_DISPLACEMENT_PX: f64 = 0.1;

/// How far each view is off, as far as that lowers the errors of what others tell of it.
pub(crate) fn align_photographs(
    radiance: &CalibratedObservations<'_>,
    views: &[View],
    exposures: &[Exposure],
    inlier_maps: &[InlierMap],
    progress: &dyn Progress,
) -> Result<Vec<Displacement>, Cancelled> {
    let zeros: Vec<Displacement> = views.iter().map(Displacement::none).collect();
    let points = ComparisonPoints::new(radiance, views, exposures, inlier_maps);
    let pictures = &radiance.observations.pictures;
    let mut current = zeros.clone();
    let passes: usize = PASSES_PER_LEVEL.iter().sum();
    let mut done = 0;
    let half = halved_pictures(pictures);
    let quarter = halved_pictures(&half);
    for (pictures, passes_of_level) in [&quarter[..], &half, pictures].into_iter().zip(PASSES_PER_LEVEL) {
        for _ in 0..passes_of_level {
            progress.check()?;
            let expected = points.predict(pictures, &current);
            let refined = |(number, before): (usize, &Displacement)| {
                let compared = points.compare(number, &pictures[number], before, &expected);
                let reduction = radiance.observations.pictures[number].reduction;
                fitting::refine_displacement(&views[number], before, &compared, reduction)
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
    let aligned = judging::retain_improvements(radiance, views, exposures, current, progress)?;
    progress.report(1.0);
    Ok(aligned)
}

/// Pictures of half as many pixels each way.
fn halved_pictures(pictures: &[PackedPicture]) -> Vec<PackedPicture> {
    pictures.par_iter().map(PackedPicture::halved).collect()
}
