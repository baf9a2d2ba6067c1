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
use super::odd::Belonging;
use super::seeing::KeptPicture;
use super::telling::Calibrated;
use points::Points;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::View;

/// How often all photographs are moved by what pictures of a quarter, half and all of their pixels each way show. What is a few pixels off is
/// less than two of the coarsest.
const PASSES: [usize; 3] = [4, 3, 2];
/// Photographs that are nowhere off by so much, px as they are kept, are not off.
const LEAST_OFF: f64 = 0.1;

/// How far each view is off, as far as that lowers the errors of what others tell of it.
pub(crate) fn displacements(
    radiance: &Calibrated<'_>,
    views: &[View],
    exposures: &[Exposure],
    belonging: &[Belonging],
    progress: &dyn Progress,
) -> Result<Vec<Displacement>, Cancelled> {
    let none: Vec<Displacement> = views.iter().map(Displacement::none).collect();
    let points = Points::of(radiance, views, exposures, belonging);
    let pictures = &radiance.sightings.pictures;
    let mut found = none.clone();
    let passes: usize = PASSES.iter().sum();
    let mut done = 0;
    let half = reduced(pictures);
    let quarter = reduced(&half);
    for (pictures, passes_of_level) in [&quarter[..], &half, pictures].into_iter().zip(PASSES) {
        for _ in 0..passes_of_level {
            progress.check()?;
            let expected = points.expected(pictures, &found);
            let moved = |(number, before): (usize, &Displacement)| {
                let compared = points.compared(number, &pictures[number], before, &expected);
                let reduction = radiance.sightings.pictures[number].reduction;
                fitting::fitted(&views[number], before, &compared, reduction)
                    .unwrap_or_else(|| before.clone())
            };
            found = found.par_iter().enumerate().map(moved).collect();
            done += 1;
            progress.report(0.8 * done as f32 / passes as f32);
        }
    }
    drop([half, quarter]);
    for ((found, none), picture) in found.iter_mut().zip(none).zip(pictures) {
        if found.most() < LEAST_OFF * f64::from(picture.reduction) {
            *found = none;
        }
    }
    let found = judging::better(radiance, views, exposures, found, progress)?;
    progress.report(1.0);
    Ok(found)
}

/// Pictures of half as many pixels each way.
fn reduced(pictures: &[KeptPicture]) -> Vec<KeptPicture> {
    pictures.par_iter().map(KeptPicture::halved).collect()
}
