//! What photographs say of the points that several of them see: on the surface, and beyond it.

use super::exposure::radius_squared;
use crate::photographs::places::{DirectionGrid, Texels};
use crate::photographs::seeing::{Observation, Observations, PictureSample};
use glam::DVec2;
use rayon::prelude::*;
use scene::View;

/// Surface points that are asked.
const MAX_POINTS: usize = 30_000;
/// Light below this share of white says little about gains.
const MIN_LIGHT: f32 = 0.004;

/// What one photograph says of one point.
pub(super) struct ExposureObservation {
    pub view: usize,
    pub stops: [f64; 3],
    pub vignetting: [f64; 2],
    pub weight: f64,
}

/// Texels that several photographs see, not too many of them.
pub(super) fn surface_points(
    texels: &Texels,
    observations: &Observations,
    views: &[View],
) -> Vec<Vec<ExposureObservation>> {
    let shared: Vec<usize> =
        (0..texels.count()).filter(|&texel| observations.of_texel(texel).len() >= 2).collect();
    let step = shared.len().div_ceil(MAX_POINTS).max(1);
    let point = |&texel: &usize| {
        let observe_view =
            |observation: &Observation| observe_texel(texels, observations, views, texel, observation);
        observations.of_texel(texel).iter().filter_map(observe_view).collect()
    };
    shared.par_iter().step_by(step).map(point).collect()
}

/// What lies beyond the surface, far enough for all photographs to see it in the same direction. Where it does not, they disagree, and
/// it counts for little.
pub(super) fn background_points(
    observations: &Observations,
    sphere: &DirectionGrid,
    views: &[View],
) -> Vec<Vec<ExposureObservation>> {
    let shared: Vec<usize> = (0..sphere.count())
        .filter(|&cell| observations.background_weights.iter().filter(|beyond| beyond[cell] > 0).count() >= 2)
        .collect();
    let step = shared.len().div_ceil(MAX_POINTS).max(1);
    let point = |&cell: &usize| {
        let direction = sphere.direction(cell).as_dvec3();
        let observe_view = |(number, view): (usize, &View)| {
            let weight = f32::from(observations.background_weights[number][cell]) / 255.0;
            if weight == 0.0 {
                return None;
            }
            let pixel = view.project(view.position() + direction)?;
            let picture = &observations.pictures[number];
            observe(number, view, pixel, picture.at(picture.place(pixel)), weight)
        };
        views.iter().enumerate().filter_map(observe_view).collect()
    };
    shared.par_iter().step_by(step).map(point).collect()
}

fn observe_texel(
    texels: &Texels,
    observations: &Observations,
    views: &[View],
    texel: usize,
    observation: &Observation,
) -> Option<ExposureObservation> {
    let number = usize::from(observation.view);
    let sample = PictureSample { light: observations.light(observation), clipped: observation.clipped() };
    observe(
        number,
        &views[number],
        views[number].project(texels.position(texel))?,
        sample,
        observation.weight(),
    )
}

fn observe(
    number: usize,
    view: &View,
    pixel: DVec2,
    sample: PictureSample,
    weight: f32,
) -> Option<ExposureObservation> {
    let darkest = sample.light.min_element();
    if sample.clipped > 0.0 || darkest < MIN_LIGHT {
        return None;
    }
    let r2 = radius_squared(view, pixel);
    // Noise of 8 bits weighs more in the dark.
    let trust = darkest / (darkest + 0.02);
    Some(ExposureObservation {
        view: number,
        stops: sample.light.to_array().map(|v| f64::from(v).log2()),
        vignetting: [r2, r2 * r2],
        weight: f64::from(weight * trust),
    })
}
