//! Estimation of E, from all photographs and from each half of them.

use super::super::calibrated::CalibratedObservations;
use super::super::directional_regression::direction_to_eye;
use super::super::reflection::mirror_direction;
use super::super::robust_averaging::{Sample, robust_mean};
use crate::photographs::texels::DirectionGrid;
use glam::{DVec3, Vec3};
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;

/// E by cell.
pub(super) struct Surroundings {
    pub from_all: Vec<Vec3>,
    /// E from each half of the photographs.
    pub from_halves: [Vec<Vec3>; 2],
}

/// Maximum number of texels used to estimate E.
const MAX_TEXELS: usize = 50_000;
/// Alternations of D and E.
const ITERATIONS: usize = 12;
/// Weight of the surrounding cells as a prior, in evidence (squared mirrored share, summed over observations).
const PRIOR_EVIDENCE: f32 = 0.005;
/// Upper bound of the evidence of one photograph for a cell, however many of its pixels reflect there.
const MAX_VIEW_EVIDENCE: f32 = 0.2 * PRIOR_EVIDENCE;

impl Surroundings {
    /// Estimates E from some of the texels, given their constant parts without it.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` asks to stop.
    pub fn solve(
        calibrated: &CalibratedObservations<'_>,
        sphere: &DirectionGrid,
        constant: &[Vec3],
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let (texels, views) = (calibrated.texels.count(), calibrated.eyes.len());
        let reflection_texels: Vec<ReflectionTexel> = (0..texels)
            .into_par_iter()
            .step_by(texels.div_ceil(MAX_TEXELS).max(1))
            .filter_map(|texel| ReflectionTexel::new(calibrated, sphere, texel, constant[texel]))
            .collect();
        let solve_stage = |from_texels, from, to| {
            solve_surroundings(sphere, from_texels, views, &Stage::new(progress, from, to))
        };
        let half = |half| reflection_texels.iter().map(|texel| texel.only_half(half)).collect();
        let from_halves = [solve_stage(half(0), 0.0, 0.25)?, solve_stage(half(1), 0.25, 0.5)?];
        Ok(Self { from_all: solve_stage(reflection_texels, 0.5, 1.0)?, from_halves })
    }
}

/// A texel used to estimate E.
pub(super) struct ReflectionTexel {
    constant: Vec3,
    samples: Vec<ReflectionSample>,
}

/// A sample with the cells around its mirrored direction.
#[derive(Clone)]
struct ReflectionSample {
    sample: Sample,
    view: u16,
    is_clipped: bool,
    around: Cells,
    share: f32,
}

/// Four cells and their weights.
type Cells = [(u32, f32); 4];

impl ReflectionTexel {
    /// What the photographs show of a texel beside its `constant` radiance. `None` if there are too few of them.
    pub fn new(
        calibrated: &CalibratedObservations<'_>,
        sphere: &DirectionGrid,
        texel: usize,
        constant: Vec3,
    ) -> Option<Self> {
        let observations = calibrated.observations.of_texel(texel);
        if observations.len() < 3 {
            return None;
        }
        let from: DVec3 = calibrated.texels.position(texel);
        let normal = calibrated.texels.shading_normal(texel);
        let mut samples = Vec::new();
        calibrated.collect_samples(texel, &mut samples);
        let reflection_samples = samples.iter().zip(observations).map(|(&sample, observation)| {
            let (direction, share) =
                mirror_direction(normal, direction_to_eye(from, calibrated.eye(observation)));
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

    /// Robust mean of the light that remains without the surroundings.
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

    /// The texel as observed by one half of the photographs.
    fn only_half(&self, half: usize) -> Self {
        let reflections =
            self.samples.iter().filter(|reflection| half_index(reflection.view) == half).cloned().collect();
        Self { constant: self.constant, samples: reflections }
    }

    /// Product and square for the regression of [`super::Mirrored`]: what each half of the photographs shows against
    /// the E of the other half.
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
        // A half without observations has no mean, and needs none.
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

/// Consecutive photographs are in different halves.
fn half_index(view: u16) -> usize {
    usize::from(view) % 2
}

/// Alternates between D and E.
fn solve_surroundings(
    sphere: &DirectionGrid,
    mut reflection_texels: Vec<ReflectionTexel>,
    views: usize,
    progress: &dyn Progress,
) -> Result<Vec<Vec3>, Cancelled> {
    // By view: indices of texels and of their samples.
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

/// E given the constant parts and the previous E. `by_view` lists the indices of texels and of their samples.
fn update_surroundings(
    sphere: &DirectionGrid,
    reflection_texels: &[ReflectionTexel],
    by_view: &[Vec<(u32, u32)>],
    before: &[Vec3],
) -> Vec<Vec3> {
    /// Difference at which the trust is one half, in roots of light.
    const HALF_TRUST_DIFFERENCE: f32 = 1.0;
    /// Views processed at once.
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
                        // Relative to the previous value: the contributions of the other three cells are subtracted.
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
