//! The background: what photographs show beyond the surface, as a picture at infinity where they agree on one.
//!
//! Objects that are not far enough away show parallax, so photographs disagree about them. There, and where no
//! photograph looks, the light of the nearest directions with evidence is used; if photographs hardly agree anywhere,
//! their mean, the same from everywhere.

use super::robust_averaging::{Sample, robust_mean, roots};
use crate::photographs::exposures::Exposure;
use crate::photographs::observations::PackedPicture;
use crate::photographs::texels::DirectionGrid;
use glam::Vec3;
use numerics::smoothstep;
use rayon::prelude::*;
use scene::View;

/// Largest difference between roots of light that agree, as a share of the brighter; below it, the difference that
/// noise and JPEG leave in the dark (white is 1.7).
const MAX_DIFFERENCE: f32 = 0.1;
const MAX_DIFFERENCE_IN_THE_DARK: f32 = 0.06;
/// Agreement between which a cell ramps from no trust to full trust. A near, bright object before a dark room has half
/// of the photographs on its side where it occludes the room.
const TRUSTED_AGREEMENT: [f32; 2] = [0.5, 0.85];
/// Below this mean agreement, over all cells that several photographs observe, there is no picture at infinity.
const MIN_AGREEMENT: f32 = 0.5;
/// Weight of the surrounding cells as a prior, in photographs.
const PRIOR_WEIGHT: f32 = 0.02;

/// Radiance of the background by cell of the grid. `view_weights` are the weights of the cells by view, in 255ths.
pub(crate) fn fit_background(
    sphere: &DirectionGrid,
    views: &[View],
    exposures: &[Exposure],
    pictures: &[PackedPicture],
    view_weights: &[Vec<u8>],
) -> Vec<Vec3> {
    let cells: Vec<DirectionStats> = (0..sphere.count())
        .into_par_iter()
        .map_init(
            || (Vec::new(), Vec::new()),
            |(samples, inlier_weights), cell| {
                let direction = sphere.direction(cell).as_dvec3();
                samples.clear();
                samples.extend((0..views.len()).filter(|&view| view_weights[view][cell] > 0).filter_map(
                    |view| {
                        let pixel = views[view].project(views[view].position() + direction)?;
                        let picture_sample = pictures[view].at(pictures[view].place(pixel));
                        let light = picture_sample.light * exposures[view].to_radiance(&views[view], pixel);
                        let weight = f32::from(view_weights[view][cell]) / 255.0;
                        Some(Sample { light, weight, clipped: picture_sample.clipped.clamp(0.0, 1.0) })
                    },
                ));
                DirectionStats::new(samples, inlier_weights)
            },
        )
        .collect();
    let shared = cells.iter().filter(|cell| cell.views >= 2);
    let (agreement_sum, count) =
        shared.fold((0.0, 0.0), |(sum, count), cell| (sum + cell.agreement, count + 1.0));
    if agreement_sum <= MIN_AGREEMENT * count || count == 0.0 {
        let (sum, weights) = cells
            .iter()
            .fold((Vec3::ZERO, 0.0), |(sum, w), cell| (sum + cell.light * cell.weight, w + cell.weight));
        let neutral = if weights > 0.0 { sum / weights } else { Vec3::ZERO };
        return vec![neutral; sphere.count()];
    }
    // One photograph alone says nothing about distance: it is trusted as much as the cells around it.
    let agreement_term = |cell: &DirectionStats| {
        let weight = if cell.views >= 2 { cell.weight } else { 0.0 };
        (Vec3::splat(cell.agreement * weight), weight)
    };
    let smoothed_agreement =
        sphere.smoothed(&cells.iter().map(agreement_term).collect::<Vec<_>>(), PRIOR_WEIGHT);
    let light_term = |(cell, agreement_around): (&DirectionStats, &Vec3)| {
        let agreement = if cell.views >= 2 { cell.agreement } else { agreement_around.x };
        let weight = cell.weight * smoothstep(agreement, TRUSTED_AGREEMENT);
        (cell.light * weight, weight)
    };
    sphere.smoothed(&cells.iter().zip(&smoothed_agreement).map(light_term).collect::<Vec<_>>(), PRIOR_WEIGHT)
}

/// Statistics of what photographs show in one direction.
struct DirectionStats {
    light: Vec3,
    weight: f32,
    views: usize,
    /// Weighted share of samples that agree with the mean.
    agreement: f32,
}

impl DirectionStats {
    fn new(samples: &[Sample], inlier_weights: &mut Vec<f32>) -> Self {
        let light = robust_mean(samples, inlier_weights);
        let agrees = |sample: &&Sample| {
            let [a, b] = [sample.light, light].map(|light| roots(light.max(Vec3::ZERO)));
            a.distance(b) <= (MAX_DIFFERENCE * a.length().max(b.length())).max(MAX_DIFFERENCE_IN_THE_DARK)
        };
        let weight = |samples: &mut dyn Iterator<Item = &Sample>| {
            samples.map(|sample| sample.weight_against(light)).sum::<f32>()
        };
        let total = weight(&mut samples.iter());
        let agreeing_weight = weight(&mut samples.iter().filter(agrees));
        let agreement = if total > 0.0 { agreeing_weight / total } else { 0.0 };
        Self { light, weight: total.min(1.0), views: samples.len(), agreement }
    }
}
