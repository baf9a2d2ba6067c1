//! Whether photographs are told better by the others once they are aligned: at texels that they were not aligned by.

use super::halves::{Half, half_of};
use super::lattice::Displacement;
use crate::photographs::exposures::Exposure;
use crate::photographs::odd;
use crate::photographs::places::Blocks;
use crate::photographs::telling::{Calibrated, Known, Work, robust_mean, toward};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::View;

/// Texels that are asked for each photograph, about.
const OF_A_VIEW: usize = 3_000;
/// A texel that fewer photographs see says nothing.
const FEWEST: usize = 4;
/// What is off by more (radiance) is something else.
const MOST: f32 = 0.25;
/// A photograph is aligned if that takes so much of what the others tell wrong of it.
const TAKES: f64 = 0.04;
/// Photographs that are not aligned change what the others are compared with: so often.
const ROUNDS: usize = 3;

/// What the others tell wrong of each photograph, summed, weighted.
fn errors(
    radiance: &Calibrated<'_>,
    views: &[View],
    exposures: &[Exposure],
    displacements: &[Displacement],
    texels: &[usize],
) -> Vec<f64> {
    let of_texel = |work: &mut Work, &texel: &usize| -> Vec<(u16, f32)> {
        let sightings = radiance.sightings.of_texel(texel);
        let from = radiance.texels.position(texel);
        radiance.samples_into(texel, &mut work.samples);
        for (sample, sighting) in work.samples.iter_mut().zip(sightings) {
            let number = usize::from(sighting.view);
            if !displacements[number].is_none()
                && let Some(pixel) = views[number].project(from)
            {
                let picture = &radiance.sightings.pictures[number];
                let shown = picture.at(picture.place(displacements[number].moved(pixel)));
                sample.light = shown.light * exposures[number].to_radiance(&views[number], pixel);
            }
        }
        let constant = robust_mean(&work.samples, &mut Vec::new());
        work.known.clear();
        for (place, (sample, sighting)) in work.samples.iter().zip(sightings).enumerate() {
            let direction = toward(from, radiance.eye(sighting));
            let weight = sample.counts(constant);
            work.known.push(Known { place, direction, residual: sample.light - constant, weight });
        }
        work.keep_best();
        work.leave_out(&odd::KERNEL);
        let wrong = work
            .known
            .iter()
            .zip(work.errors())
            .map(|(known, error)| (sightings[known.place].view, known.weight * error.length().min(MOST)));
        wrong.collect()
    };
    let found: Vec<Vec<(u16, f32)>> = texels.par_iter().map_init(Work::new, of_texel).collect();
    let mut sums = vec![0.0; views.len()];
    for (view, wrong) in found.into_iter().flatten() {
        sums[usize::from(view)] += f64::from(wrong);
    }
    sums
}

/// Those of the displacements that lower the errors, the others none.
pub(super) fn better(
    radiance: &Calibrated<'_>,
    views: &[View],
    exposures: &[Exposure],
    mut displacements: Vec<Displacement>,
    progress: &dyn Progress,
) -> Result<Vec<Displacement>, Cancelled> {
    if displacements.iter().all(Displacement::is_none) {
        return Ok(displacements);
    }
    let none: Vec<Displacement> = views.iter().map(Displacement::none).collect();
    let blocks = Blocks::of(radiance.texels.size());
    let is_judging = |texel: &usize| {
        radiance.sightings.range(*texel).len() >= FEWEST
            && half_of(&blocks, radiance.texels, *texel) == Half::Judging
    };
    let texels: Vec<usize> = (0..radiance.texels.count()).filter(is_judging).collect();
    let count: usize = texels.iter().map(|&texel| radiance.sightings.range(texel).len()).sum();
    let step = count.div_ceil(OF_A_VIEW * views.len()).max(1);
    let texels: Vec<usize> = texels.into_iter().step_by(step).collect();
    let before = errors(radiance, views, exposures, &none, &texels);
    for _ in 0..ROUNDS {
        progress.check()?;
        let after = errors(radiance, views, exposures, &displacements, &texels);
        let mut is_changed = false;
        for (view, none) in none.iter().enumerate() {
            let is_better = after[view] < (1.0 - TAKES) * before[view];
            if !displacements[view].is_none() && !is_better {
                displacements[view] = none.clone();
                is_changed = true;
            }
        }
        if !is_changed || displacements.iter().all(Displacement::is_none) {
            return Ok(displacements);
        }
    }
    // What still changes is told by nobody for sure.
    let after = errors(radiance, views, exposures, &displacements, &texels);
    let is_better = after.iter().sum::<f64>() < (1.0 - TAKES) * before.iter().sum::<f64>();
    Ok(if is_better { displacements } else { none })
}
