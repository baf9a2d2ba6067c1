//! What photographs say of the points that several of them see: on the surface, and beyond it.

use super::exposure::radius_squared;
use crate::photographs::places::{Sphere, Texels};
use crate::photographs::seeing::{Shown, Sighting, Sightings};
use glam::DVec2;
use rayon::prelude::*;
use scene::View;

/// Surface points that are asked.
const POINTS: usize = 30_000;
/// Light below this share of white says little about gains.
const DARK: f32 = 0.004;

/// What one photograph says of one point.
pub(super) struct Said {
    pub view: usize,
    pub stops: [f64; 3],
    pub vignetting: [f64; 2],
    pub weight: f64,
}

/// Texels that several photographs see, not too many of them.
pub(super) fn near_points(texels: &Texels, sightings: &Sightings, views: &[View]) -> Vec<Vec<Said>> {
    let shared: Vec<usize> =
        (0..texels.count()).filter(|&texel| sightings.of_texel(texel).len() >= 2).collect();
    let step = shared.len().div_ceil(POINTS).max(1);
    let point = |&texel: &usize| {
        let said = |s: &Sighting| said(texels, sightings, views, texel, s);
        sightings.of_texel(texel).iter().filter_map(said).collect()
    };
    shared.par_iter().step_by(step).map(point).collect()
}

/// What lies beyond the surface, far enough for all photographs to see it in the same direction. Where it does not, they disagree, and
/// it counts for little.
pub(super) fn far_points(sightings: &Sightings, sphere: &Sphere, views: &[View]) -> Vec<Vec<Said>> {
    let shared: Vec<usize> = (0..sphere.count())
        .filter(|&cell| sightings.beyond.iter().filter(|beyond| beyond[cell] > 0).count() >= 2)
        .collect();
    let step = shared.len().div_ceil(POINTS).max(1);
    let point = |&cell: &usize| {
        let direction = sphere.direction(cell).as_dvec3();
        let said = |(number, view): (usize, &View)| {
            let weight = f32::from(sightings.beyond[number][cell]) / 255.0;
            if weight == 0.0 {
                return None;
            }
            let pixel = view.project(view.position() + direction)?;
            let picture = &sightings.pictures[number];
            say(number, view, pixel, picture.at(picture.place(pixel)), weight)
        };
        views.iter().enumerate().filter_map(said).collect()
    };
    shared.par_iter().step_by(step).map(point).collect()
}

fn said(
    texels: &Texels,
    sightings: &Sightings,
    views: &[View],
    texel: usize,
    sighting: &Sighting,
) -> Option<Said> {
    let number = usize::from(sighting.view);
    let shown = Shown { light: sightings.light(sighting), clipped: sighting.clipped() };
    say(number, &views[number], views[number].project(texels.position(texel))?, shown, sighting.weight())
}

fn say(number: usize, view: &View, pixel: DVec2, shown: Shown, weight: f32) -> Option<Said> {
    let least = shown.light.min_element();
    if shown.clipped > 0.0 || least < DARK {
        return None;
    }
    let r2 = radius_squared(view, pixel);
    // Noise of 8 bits weighs more in the dark.
    let trust = least / (least + 0.02);
    Some(Said {
        view: number,
        stops: shown.light.to_array().map(|v| f64::from(v).log2()),
        vignetting: [r2, r2 * r2],
        weight: f64::from(weight * trust),
    })
}
