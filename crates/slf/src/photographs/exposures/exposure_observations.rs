//! Observations that exposures are solved from: points seen by several photographs, on the surface and in the
//! background.

use super::exposure::radius_squared;
use crate::photographs::observations::{Observation, Observations, PictureSample};
use crate::photographs::texels::{DirectionGrid, Texels};
use glam::DVec2;
use rayon::prelude::*;
use scene::View;

/// Maximum number of points used, of either kind.
const MAX_POINTS: usize = 30_000;
/// Light below this share of white says little about gains.
const MIN_LIGHT: f32 = 0.004;

/// One photograph's observation of one point.
pub(super) struct ExposureObservation {
    pub view: usize,
    pub stops: [f64; 3],
    pub vignetting: [f64; 2],
    pub weight: f64,
}

/// A limited number of texels that several photographs observe.
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

/// Background directions that several photographs observe. Where the background is not far enough to be seen in the
/// same direction by all, they disagree and get little weight.
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
        let observe_view = |(view_index, view): (usize, &View)| {
            let weight = f32::from(observations.background_weights[view_index][cell]) / 255.0;
            if weight == 0.0 {
                return None;
            }
            let pixel = view.project(view.position() + direction)?;
            let picture = &observations.pictures[view_index];
            observe(view_index, view, pixel, picture.at(picture.place(pixel)), weight)
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
    let view_index = usize::from(observation.view);
    let sample = PictureSample { light: observations.light(observation), clipped: observation.clipped() };
    observe(
        view_index,
        &views[view_index],
        views[view_index].project(texels.position(texel))?,
        sample,
        observation.weight(),
    )
}

fn observe(
    view_index: usize,
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
    // Quantisation to 8 bits is coarser in the dark.
    let trust = darkest / (darkest + 0.02);
    Some(ExposureObservation {
        view: view_index,
        stops: sample.light.to_array().map(|v| f64::from(v).log2()),
        vignetting: [r2, r2 * r2],
        weight: f64::from(weight * trust),
    })
}
