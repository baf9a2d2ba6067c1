//! E, found from all photographs, and from each half of them.

use super::super::calibrated::Calibrated;
use super::super::constant::{Sample, robust_mean};
use super::super::directions::toward;
use super::super::reflection::reflection;
use crate::photographs::places::Sphere;
use glam::{DVec3, Vec3};
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;

/// E by cell.
pub(super) struct Surroundings {
    pub of_all: Vec<Vec3>,
    /// As one half of the photographs tells it, and as the other.
    pub of_halves: [Vec<Vec3>; 2],
}

/// Texels that E is found from.
const ASKED: usize = 50_000;
/// Turns of D and E.
const TURNS: usize = 12;
/// Cells are held at what lies around them as by so much evidence (squared share of light, summed over sightings).
const HOLD: f32 = 0.005;
/// One photograph is no more evidence of a cell than this, however many of its pixels look there.
const MOST_OF_VIEW: f32 = 0.2 * HOLD;

impl Surroundings {
    /// From some of the texels, whose constant parts are known as they are without it.
    pub fn find(
        radiance: &Calibrated<'_>,
        sphere: &Sphere,
        constant: &[Vec3],
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let (texels, views) = (radiance.texels.count(), radiance.eyes.len());
        let asked: Vec<Asked> = (0..texels)
            .into_par_iter()
            .step_by(texels.div_ceil(ASKED).max(1))
            .filter_map(|texel| Asked::of(radiance, sphere, texel, constant[texel]))
            .collect();
        let find = |asked, from, to| found(sphere, asked, views, &Stage::new(progress, from, to));
        let half = |half| asked.iter().map(|point| point.of_half(half)).collect();
        let of_halves = [find(half(0), 0.0, 0.25)?, find(half(1), 0.25, 0.5)?];
        Ok(Self { of_all: find(asked, 0.5, 1.0)?, of_halves })
    }
}

/// A texel that E is found from.
pub(super) struct Asked {
    constant: Vec3,
    seen: Vec<Seen>,
}

/// A sample and the cells around its mirrored direction.
#[derive(Clone)]
struct Seen {
    sample: Sample,
    view: u16,
    is_clipped: bool,
    around: Cells,
    share: f32,
}

/// Four cells and their shares.
type Cells = [(u32, f32); 4];

impl Asked {
    pub fn of(radiance: &Calibrated<'_>, sphere: &Sphere, texel: usize, constant: Vec3) -> Option<Self> {
        let sightings = radiance.sightings.of_texel(texel);
        if sightings.len() < 3 {
            return None;
        }
        let from: DVec3 = radiance.texels.position(texel);
        let normal = radiance.texels.shading_normal(texel);
        let mut samples = Vec::new();
        radiance.samples_into(texel, &mut samples);
        let seen = samples.iter().zip(sightings).map(|(&sample, sighting)| {
            let (direction, share) = reflection(normal, toward(from, radiance.eye(sighting)));
            let around = sphere.around(direction).map(|(cell, weight)| (cell as u32, weight));
            let share = if sighting.is_blocked() { 0.0 } else { share };
            Seen { sample, view: sighting.view, is_clipped: sighting.clipped() > 0.0, around, share }
        });
        Some(Self { constant, seen: seen.collect() })
    }

    /// The mean of what remains without the surroundings.
    fn without(&self, surroundings: &[Vec3], samples: &mut Vec<Sample>, belonging: &mut Vec<f32>) -> Vec3 {
        samples.clear();
        samples.extend(self.seen.iter().map(|seen| {
            let light = seen.sample.light - seen.mirrored(surroundings);
            seen.sample.with_light(light)
        }));
        robust_mean(samples, belonging).max(Vec3::ZERO)
    }

    /// What is seen by one half of the photographs.
    fn of_half(&self, half: usize) -> Self {
        let seen = self.seen.iter().filter(|seen| half_of(seen.view) == half).cloned().collect();
        Self { constant: self.constant, seen }
    }

    /// Product and square of [`super::Mirrored`]'s regression: what each half of the photographs shows, beside what the other half tells.
    pub fn covariance(&self, halves: &[Vec<Vec3>; 2]) -> (f32, f32) {
        let told: Vec<Vec3> =
            self.seen.iter().map(|seen| seen.mirrored(&halves[1 - half_of(seen.view)])).collect();
        let (mut light, mut mirrored, mut weights) = (Vec3::ZERO, [Vec3::ZERO; 2], [0.0; 2]);
        for (seen, told) in self.seen.iter().zip(&told) {
            let (half, weight) = (half_of(seen.view), seen.sample.counts_at_least());
            light += seen.sample.light * weight;
            mirrored[half] += *told * weight;
            weights[half] += weight;
        }
        light /= weights[0] + weights[1];
        // A half that sees nothing has no mean, and is not asked for it.
        let mirrored = [0, 1].map(|half| mirrored[half] / weights[half].max(f32::MIN_POSITIVE));
        self.seen.iter().zip(&told).fold((0.0, 0.0), |(product, square), (seen, told)| {
            let told = *told - mirrored[half_of(seen.view)];
            let weight = seen.sample.counts_at_least();
            (product + told.dot(seen.sample.light - light) * weight, square + told.length_squared() * weight)
        })
    }
}

impl Seen {
    fn mirrored(&self, surroundings: &[Vec3]) -> Vec3 {
        self.around.iter().map(|&(cell, weight)| surroundings[cell as usize] * weight).sum::<Vec3>()
            * self.share
    }
}

/// Photographs beside each other are of different halves.
fn half_of(view: u16) -> usize {
    usize::from(view) % 2
}

/// E, from what is asked.
fn found(
    sphere: &Sphere,
    mut asked: Vec<Asked>,
    views: usize,
    progress: &dyn Progress,
) -> Result<Vec<Vec3>, Cancelled> {
    // Which points, and which of their samples, are of each view.
    let mut by_view = vec![Vec::new(); views];
    for (point, asked) in asked.iter().enumerate() {
        for (number, seen) in asked.seen.iter().enumerate() {
            by_view[usize::from(seen.view)].push((point as u32, number as u32));
        }
    }
    let mut surroundings = vec![Vec3::ZERO; sphere.count()];
    for turn in 0..TURNS {
        progress.check()?;
        progress.report(turn as f32 / TURNS as f32);
        surroundings = looked_up(sphere, &asked, &by_view, &surroundings);
        asked.par_iter_mut().for_each_init(
            || (Vec::new(), Vec::new()),
            |(samples, belonging), point| {
                point.constant = point.without(&surroundings, samples, belonging);
            },
        );
    }
    Ok(surroundings)
}

/// E as the constant parts leave it, from what it was; by view, the numbers of points and of their samples.
fn looked_up(sphere: &Sphere, asked: &[Asked], by_view: &[Vec<(u32, u32)>], before: &[Vec3]) -> Vec<Vec3> {
    /// What lies off by this is trusted half, in roots of light.
    const SCALE: f32 = 1.0;
    /// Views that are worked on at once.
    const AT_ONCE: usize = 8;
    let mut sums = vec![(Vec3::ZERO, 0.0f32); sphere.count()];
    for views in by_view.chunks(AT_ONCE) {
        let parts: Vec<Vec<(Vec3, f32)>> = views
            .par_iter()
            .map(|seen| {
                let mut sums = vec![(Vec3::ZERO, 0.0f32); sphere.count()];
                for &(point, number) in seen {
                    let point = &asked[point as usize];
                    let seen = &point.seen[number as usize];
                    let known = seen.mirrored(before);
                    let left = seen.sample.light - point.constant;
                    if seen.is_clipped && known.cmpge(left).all() {
                        continue;
                    }
                    let off = (left - known).length() / (SCALE * (0.05 + point.constant.length()).sqrt());
                    let trust = seen.sample.counts_at_least() * seen.share / (1.0 + off * off);
                    for (cell, weight) in seen.around {
                        let cell = cell as usize;
                        let sum = &mut sums[cell];
                        // Toward the old value: what the other three cells tell is taken away.
                        sum.0 += (left - known + before[cell] * seen.share) * (trust * weight);
                        sum.1 += seen.share * trust * weight;
                    }
                }
                sums
            })
            .collect();
        for part in parts {
            for (sum, (light, weight)) in sums.iter_mut().zip(part) {
                let share = if weight > MOST_OF_VIEW { MOST_OF_VIEW / weight } else { 1.0 };
                sum.0 += light * share;
                sum.1 += weight * share;
            }
        }
    }
    sphere.smoothed(&sums, HOLD).into_iter().map(|light| light.max(Vec3::ZERO)).collect()
}
