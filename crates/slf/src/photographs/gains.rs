//! Exposure, white balance and vignetting of all photographs, from surface points that several of them see.
//!
//! ```text
//! log₂ I(v, c, x) = log₂ D(c, x) + g(v, c) + k₁(l)·r² + k₂(l)·r⁴
//! ```
//!
//! | symbol | meaning | unit |
//! | --- | --- | --- |
//! | I | light that photograph v shows of point x in channel c | its white |
//! | D | light of the point, the same for all that see it | |
//! | g | gain of photograph and channel; its mean over photographs is 0 | stops |
//! | k₁, k₂ | vignetting of lens l | stops |
//! | r | distance from the lens's axis, over half the picture's diagonal | |
//!
//! D falls out: of every point only differences from its weighted mean count (Goldman 2010, without his response curve). Points that gloss
//! or occlusion differ at are left out by Cauchy's weights, their scale the median of what is left over.

use super::kept_picture::Shown;
use super::median::median;
use super::positive::solve_positive;
use super::sightings::{Sighting, Sightings};
use super::sphere::Sphere;
use super::texels::Texels;
use glam::{DVec2, Vec3};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::View;

/// How a photograph renders light.
#[derive(Clone, Copy, Debug, PartialEq, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Exposure {
    /// Gain of red, green and blue, stops; the mean over all photographs is 0 in each channel.
    pub gain_stops: [f64; 3],
    /// k₁ and k₂: what r² and r⁴ add, stops.
    pub vignetting_stops: [f64; 2],
}

impl Exposure {
    /// What the photograph's numbers are to be multiplied with at a pixel position of the view.
    pub fn to_radiance(&self, view: &View, pixel: DVec2) -> Vec3 {
        let falloff = self.falloff_stops(view, pixel);
        Vec3::from_array(self.gain_stops.map(|gain| (-(gain + falloff)).exp2() as f32))
    }

    /// The most that [`Self::to_radiance`] can be in the picture, of any channel.
    pub(crate) fn most_to_radiance(&self, view: &View) -> f32 {
        // k₁·r² + k₂·r⁴ over r² in [0, most] is least at an end or where its slope is 0.
        let [k1, k2] = self.vignetting_stops;
        let size = DVec2::from(view.lens.size_px().map(f64::from));
        let corners = [DVec2::ZERO, size, DVec2::new(size.x, 0.0), DVec2::new(0.0, size.y)];
        let most = corners.map(|corner| radius_squared(view, corner)).into_iter().fold(0.0, f64::max);
        let turn = if k2 > 0.0 { (-k1 / (2.0 * k2)).clamp(0.0, most) } else { 0.0 };
        let falloff = [0.0, most, turn].map(|r2| (k1 + k2 * r2) * r2).into_iter().fold(0.0, f64::min);
        let gain = self.gain_stops.into_iter().fold(f64::INFINITY, f64::min);
        (-(gain + falloff)).exp2() as f32
    }

    fn falloff_stops(&self, view: &View, pixel: DVec2) -> f64 {
        let [k1, k2] = self.vignetting_stops;
        let r2 = radius_squared(view, pixel);
        (k1 + k2 * r2) * r2
    }
}

/// r² of the module's head.
fn radius_squared(view: &View, pixel: DVec2) -> f64 {
    let intrinsics = view.lens.intrinsics();
    let half_diagonal = DVec2::from(intrinsics.size_px.map(f64::from)).length() / 2.0;
    (pixel - DVec2::from(intrinsics.principal_px)).length_squared() / (half_diagonal * half_diagonal)
}

/// Surface points that are asked.
const POINTS: usize = 30_000;
/// Light below this share of white says little about gains.
const DARK: f32 = 0.004;
/// Rounds of reweighting; weights have settled by then.
const ROUNDS: usize = 16;
/// Residuals are thought to be no smaller, stops.
const LEAST_SCALE: f64 = 0.03;
/// What holds a gain that nothing else does (at its hint, or at 0): as much as half a point.
const HOLD: f64 = 0.5;
/// What holds the channels of a photograph together, as points: its white balance is at first thought to be that of all others, so that
/// a colour that is dark in some does not lead them astray.
const HOLD_WHITE_AT_FIRST: f64 = 1e5;
/// And then on.
const HOLD_WHITE: f64 = 100.0;
/// What holds vignetting at 0: as much as so many points one stop off.
const HOLD_VIGNETTING: f64 = 20.0;

/// What one photograph says of one point.
struct Said {
    view: usize,
    stops: [f64; 3],
    vignetting: [f64; 2],
    weight: f64,
}

/// Finds the exposures of all views.
pub(crate) fn exposures(
    texels: &Texels,
    sightings: &Sightings,
    sphere: &Sphere,
    views: &[View],
    progress: &dyn Progress,
) -> Result<Vec<Exposure>, Cancelled> {
    let lens_of = lenses(views);
    let lens_count = lens_of.iter().max().map_or(0, |most| most + 1);
    let shared: Vec<usize> =
        (0..texels.count()).filter(|&texel| sightings.of_texel(texel).len() >= 2).collect();
    let step = shared.len().div_ceil(POINTS).max(1);
    let near: Vec<Vec<Said>> = shared
        .par_iter()
        .step_by(step)
        .map(|&texel| {
            let said = |s: &Sighting| said(texels, sightings, views, texel, s);
            sightings.of_texel(texel).iter().filter_map(said).collect()
        })
        .collect();
    let far = far_points(sightings, sphere, views);
    let unknowns = 3 * views.len() + 2 * lens_count;
    let hints = hints(views);
    let mut solution = vec![0.0; unknowns];
    for (view, hint) in hints.iter().enumerate() {
        solution[3 * view..3 * view + 3].fill(hint.unwrap_or(0.0));
    }
    let mut scales = [1.0; 2];
    for round in 0..ROUNDS {
        progress.check()?;
        progress.report(round as f32 / ROUNDS as f32);
        let system = System { unknowns, views: views.len(), lens_of: &lens_of };
        let (mut matrix, mut right) = (vec![0.0; unknowns * unknowns], vec![0.0; unknowns]);
        // What agrees better says more: by the square of its scale.
        let trust = scales.map(|scale: f64| (scales[0].min(scales[1]) / scale).powi(2));
        for ((points, scale), trust) in [&near, &far].into_iter().zip(&mut scales).zip(trust) {
            let parts: Vec<(Vec<f64>, Vec<f64>, Vec<f64>)> =
                points.par_chunks(2048).map(|points| system.of_points(points, &solution, *scale)).collect();
            let mut left_over = Vec::new();
            for (part, part_right, errors) in parts {
                matrix.iter_mut().zip(part).for_each(|(sum, value)| *sum += trust * value);
                right.iter_mut().zip(part_right).for_each(|(sum, value)| *sum += trust * value);
                left_over.extend(errors);
            }
            if let Some(middle) = median(&mut left_over, f64::total_cmp) {
                // Of a normal distribution.
                *scale = (1.4826 * middle).max(LEAST_SCALE);
            }
        }
        let hold_white = if round < ROUNDS / 2 { HOLD_WHITE_AT_FIRST } else { HOLD_WHITE };
        for view in 0..views.len() {
            for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (3 * view + a, 3 * view + b)) {
                matrix[a * unknowns + a] += hold_white;
                matrix[b * unknowns + b] += hold_white;
                matrix[a * unknowns + b] -= hold_white;
                matrix[b * unknowns + a] -= hold_white;
            }
        }
        for unknown in 0..unknowns {
            let is_gain = unknown < 3 * views.len();
            let hold = if is_gain { HOLD } else { HOLD_VIGNETTING };
            matrix[unknown * unknowns + unknown] += hold;
            if is_gain {
                right[unknown] += hold * hints[unknown / 3].unwrap_or(0.0);
            }
        }
        solve_positive(&mut matrix, &mut right);
        solution = right;
    }
    let mean = |channel: usize| {
        (0..views.len()).map(|view| solution[3 * view + channel]).sum::<f64>() / views.len().max(1) as f64
    };
    let mean = [mean(0), mean(1), mean(2)];
    Ok((0..views.len())
        .map(|view| Exposure {
            gain_stops: std::array::from_fn(|channel| solution[3 * view + channel] - mean[channel]),
            vignetting_stops: std::array::from_fn(|k| solution[3 * views.len() + 2 * lens_of[view] + k]),
        })
        .collect())
}

/// Views with the same lens have the same number.
fn lenses(views: &[View]) -> Vec<usize> {
    let mut known: Vec<&View> = Vec::new();
    let mut numbers = Vec::with_capacity(views.len());
    for view in views {
        numbers.push(known.iter().position(|other| other.lens == view.lens).unwrap_or(known.len()));
        if numbers.last() == Some(&known.len()) {
            known.push(view);
        }
    }
    numbers
}

/// What EXIF says of each view's gain, relative to the mean of those that say anything.
fn hints(views: &[View]) -> Vec<Option<f64>> {
    let said: Vec<f64> =
        views.iter().filter_map(|view| view.exposure_hint).filter(|h| h.is_finite()).collect();
    let mean = said.iter().sum::<f64>() / said.len().max(1) as f64;
    views.iter().map(|view| view.exposure_hint.filter(|h| h.is_finite()).map(|hint| hint - mean)).collect()
}

/// What lies beyond the surface, far enough for all photographs to see it in the same direction. Where it does not, they disagree, and
/// it counts for little.
fn far_points(sightings: &Sightings, sphere: &Sphere, views: &[View]) -> Vec<Vec<Said>> {
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

/// The normal equations.
struct System<'a> {
    unknowns: usize,
    views: usize,
    lens_of: &'a [usize],
}

impl System<'_> {
    /// Matrix, right side and absolute residuals of some points, weighted by how a solution explains them.
    fn of_points(
        &self,
        points: &[Vec<Said>],
        solution: &[f64],
        scale: f64,
    ) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let n = self.unknowns;
        let (mut matrix, mut right, mut errors) = (vec![0.0; n * n], vec![0.0; n], Vec::new());
        let mut mean_row = vec![0.0; n];
        for point in points {
            for channel in 0..3 {
                let row = |said: &Said| {
                    let lens = 3 * self.views + 2 * self.lens_of[said.view];
                    let [k1, k2] = said.vignetting;
                    [(3 * said.view + channel, 1.0), (lens, k1), (lens + 1, k2)]
                };
                let off = |said: &Said| {
                    let told: f64 = row(said).iter().map(|&(at, factor)| factor * solution[at]).sum();
                    said.stops[channel] - told
                };
                // The point's own light, as most say: a median holds out where half of them are wrong.
                let mut all: Vec<f64> = point.iter().map(off).collect();
                if all.len() < 2 {
                    continue;
                }
                let middle = median(&mut all, f64::total_cmp).unwrap_or(0.0);
                let (mut weights, mut mean) = (0.0, 0.0);
                let mut touched = Vec::with_capacity(point.len() * 3);
                for said in point {
                    let error = off(said) - middle;
                    errors.push(error.abs());
                    let weight = said.weight / (1.0 + (error / scale).powi(2));
                    weights += weight;
                    mean += weight * said.stops[channel];
                    let row = row(said);
                    for &(i, a) in &row {
                        right[i] += weight * a * said.stops[channel];
                        for &(j, b) in &row {
                            matrix[i * n + j] += weight * a * b;
                        }
                        mean_row[i] += weight * a;
                        touched.push(i);
                    }
                }
                touched.sort_unstable();
                touched.dedup();
                if weights > 0.0 {
                    for &i in &touched {
                        right[i] -= mean_row[i] * mean / weights;
                        for &j in &touched {
                            matrix[i * n + j] -= mean_row[i] * mean_row[j] / weights;
                        }
                    }
                }
                for &i in &touched {
                    mean_row[i] = 0.0;
                }
            }
        }
        (matrix, right, errors)
    }
}
