//! E, found from all photographs, and from each half of them.

use super::super::calibrated::CalibratedObservations;
use super::super::constant::{Sample, robust_mean};
use super::super::directions::direction_to_eye;
use super::super::reflection::mirror_direction;
use crate::photographs::places::DirectionGrid;
use glam::{DVec3, Vec3};
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;

/// E by cell.
pub(super) struct Surroundings {
    pub from_all: Vec<Vec3>,
    /// As one half of the photographs tells it, and as the other.
    pub from_halves: [Vec<Vec3>; 2],
}

/// Texels that E is found from.
const MAX_TEXELS: usize = 50_000;
/// Turns of D and E.
const ITERATIONS: usize = 12;
/// Cells are held at what lies around them as by so much evidence (squared share of light, summed over sightings).
const PRIOR_EVIDENCE: f32 = 0.005;
/// One photograph is no more evidence of a cell than this, however many of its pixels look there.
const MAX_VIEW_EVIDENCE: f32 = 0.2 * PRIOR_EVIDENCE;

impl Surroundings {
    /// From some of the texels, whose constant parts are known as they are without it.
    pub fn solve(
        radiance: &CalibratedObservations<'_>,
        sphere: &DirectionGrid,
        constant: &[Vec3],
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let (texels, views) = (radiance.texels.count(), radiance.eyes.len());
        let reflection_texels: Vec<ReflectionTexel> = (0..texels)
            .into_par_iter()
            .step_by(texels.div_ceil(MAX_TEXELS).max(1))
            .filter_map(|texel| ReflectionTexel::new(radiance, sphere, texel, constant[texel]))
            .collect();
        let solve_stage = |from_texels, from, to| {
            solve_surroundings(sphere, from_texels, views, &Stage::new(progress, from, to))
        };
        let half = |half| reflection_texels.iter().map(|point| point.only_half(half)).collect();
        let from_halves = [solve_stage(half(0), 0.0, 0.25)?, solve_stage(half(1), 0.25, 0.5)?];
        Ok(Self { from_all: solve_stage(reflection_texels, 0.5, 1.0)?, from_halves })
    }
}

/// A texel that E is found from.
pub(super) struct ReflectionTexel {
    constant: Vec3,
    samples: Vec<ReflectionSample>,
}

/// A sample and the cells around its mirrored direction.
#[derive(Clone)]
struct ReflectionSample {
    sample: Sample,
    view: u16,
    is_clipped: bool,
    around: Cells,
    share: f32,
}

/// Four cells and their shares.
type Cells = [(u32, f32); 4];

impl ReflectionTexel {
    pub fn new(
        radiance: &CalibratedObservations<'_>,
        sphere: &DirectionGrid,
        texel: usize,
        constant: Vec3,
    ) -> Option<Self> {
        let observations = radiance.observations.of_texel(texel);
        if observations.len() < 3 {
            return None;
        }
        let from: DVec3 = radiance.texels.position(texel);
        let normal = radiance.texels.shading_normal(texel);
        let mut samples = Vec::new();
        radiance.collect_samples(texel, &mut samples);
        let reflection_samples = samples.iter().zip(observations).map(|(&sample, observation)| {
            let (direction, share) =
                mirror_direction(normal, direction_to_eye(from, radiance.eye(observation)));
            let around = sphere.around(direction).map(|(cell, weight)| (cell as u32, weight));
            let share = if observation.is_blocked() { 0.0 } else { share };
            ReflectionSample {
                sample,
                view: observation.view,
                is_clipped: observation.clipped() > 0.0,
                around,
                share,
            }
        });
        Some(Self { constant, samples: reflection_samples.collect() })
    }

    /// The mean of what remains without the surroundings.
    fn constant_without(
        &self,
        surroundings: &[Vec3],
        samples: &mut Vec<Sample>,
        inlier_weights: &mut Vec<f32>,
    ) -> Vec3 {
        samples.clear();
        samples.extend(self.samples.iter().map(|reflection| {
            let light = reflection.sample.light - reflection.mirrored_light(surroundings);
            reflection.sample.with_light(light)
        }));
        robust_mean(samples, inlier_weights).max(Vec3::ZERO)
    }

    /// What is seen by one half of the photographs.
    fn only_half(&self, half: usize) -> Self {
        let reflections =
            self.samples.iter().filter(|reflections| half_index(reflections.view) == half).cloned().collect();
        Self { constant: self.constant, samples: reflections }
    }

    /// Product and square of [`super::Mirrored`]'s regression: what each half of the photographs shows, beside what the other half tells.
    pub fn covariance(&self, halves: &[Vec<Vec3>; 2]) -> (f32, f32) {
        let predictions: Vec<Vec3> = self
            .samples
            .iter()
            .map(|reflection| reflection.mirrored_light(&halves[1 - half_index(reflection.view)]))
            .collect();
        let (mut light, mut mirrored, mut weights) = (Vec3::ZERO, [Vec3::ZERO; 2], [0.0; 2]);
        for (reflection, prediction) in self.samples.iter().zip(&predictions) {
            let (half, weight) = (half_index(reflection.view), reflection.sample.min_weight());
            light += reflection.sample.light * weight;
            mirrored[half] += *prediction * weight;
            weights[half] += weight;
        }
        light /= weights[0] + weights[1];
        // A half that sees nothing has no mean, and is not asked for it.
        let mirrored = [0, 1].map(|half| mirrored[half] / weights[half].max(f32::MIN_POSITIVE));
        self.samples.iter().zip(&predictions).fold(
            (0.0, 0.0),
            |(product, square), (reflection, prediction)| {
                let deviation = *prediction - mirrored[half_index(reflection.view)];
                let weight = reflection.sample.min_weight();
                (
                    product + deviation.dot(reflection.sample.light - light) * weight,
                    square + deviation.length_squared() * weight,
                )
            },
        )
    }
}

impl ReflectionSample {
    fn mirrored_light(&self, surroundings: &[Vec3]) -> Vec3 {
        self.around.iter().map(|&(cell, weight)| surroundings[cell as usize] * weight).sum::<Vec3>()
            * self.share
    }
}

/// Photographs beside each other are of different halves.
fn half_index(view: u16) -> usize {
    usize::from(view) % 2
}

/// E, from what is asked.
fn solve_surroundings(
    sphere: &DirectionGrid,
    mut reflection_texels: Vec<ReflectionTexel>,
    views: usize,
    progress: &dyn Progress,
) -> Result<Vec<Vec3>, Cancelled> {
    // Which points, and which of their samples, are of each view.
    let mut by_view = vec![Vec::new(); views];
    for (point, texel) in reflection_texels.iter().enumerate() {
        for (number, reflection) in texel.samples.iter().enumerate() {
            by_view[usize::from(reflection.view)].push((point as u32, number as u32));
        }
    }
    let mut surroundings = vec![Vec3::ZERO; sphere.count()];
    for iteration in 0..ITERATIONS {
        progress.check()?;
        progress.report(iteration as f32 / ITERATIONS as f32);
        surroundings = update_surroundings(sphere, &reflection_texels, &by_view, &surroundings);
        reflection_texels.par_iter_mut().for_each_init(
            || (Vec::new(), Vec::new()),
            |(samples, inlier_weights), point| {
                point.constant = point.constant_without(&surroundings, samples, inlier_weights);
            },
        );
    }
    Ok(surroundings)
}

/// E as the constant parts leave it, from what it was; by view, the numbers of points and of their samples.
fn update_surroundings(
    sphere: &DirectionGrid,
    reflection_texels: &[ReflectionTexel],
    by_view: &[Vec<(u32, u32)>],
    before: &[Vec3],
) -> Vec<Vec3> {
    /// What lies off by this is trusted half, in roots of light.
    const HALF_TRUST_DIFFERENCE: f32 = 1.0;
    /// Views that are worked on at once.
    const AT_ONCE: usize = 8;
    let mut sums = vec![(Vec3::ZERO, 0.0f32); sphere.count()];
    for views in by_view.chunks(AT_ONCE) {
        let sums_by_view: Vec<Vec<(Vec3, f32)>> = views
            .par_iter()
            .map(|references| {
                let mut sums = vec![(Vec3::ZERO, 0.0f32); sphere.count()];
                for &(point, number) in references {
                    let point = &reflection_texels[point as usize];
                    let reflection = &point.samples[number as usize];
                    let predicted = reflection.mirrored_light(before);
                    let remainder = reflection.sample.light - point.constant;
                    if reflection.is_clipped && predicted.cmpge(remainder).all() {
                        continue;
                    }
                    let scaled_error = (remainder - predicted).length()
                        / (HALF_TRUST_DIFFERENCE * (0.05 + point.constant.length()).sqrt());
                    let trust = reflection.sample.min_weight() * reflection.share
                        / (1.0 + scaled_error * scaled_error);
                    for (cell, weight) in reflection.around {
                        let cell = cell as usize;
                        let sum = &mut sums[cell];
                        // Toward the old value: what the other three cells tell is taken away.
                        sum.0 += (remainder - predicted + before[cell] * reflection.share) * (trust * weight);
                        sum.1 += reflection.share * trust * weight;
                    }
                }
                sums
            })
            .collect();
        for view_sums in sums_by_view {
            for (sum, (light, weight)) in sums.iter_mut().zip(view_sums) {
                let share = if weight > MAX_VIEW_EVIDENCE { MAX_VIEW_EVIDENCE / weight } else { 1.0 };
                sum.0 += light * share;
                sum.1 += weight * share;
            }
        }
    }
    sphere.smoothed(&sums, PRIOR_EVIDENCE).into_iter().map(|light| light.max(Vec3::ZERO)).collect()
}
