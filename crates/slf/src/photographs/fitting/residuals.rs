//! Residuals toward each photograph beside the constant and mirrored parts, and the confidence in them.
//!
//! Leave-one-out prediction (`directional_regression`) decides: which kernel; by blocks of texels, whether reflections
//! are better modelled by the surroundings or, like all other light, at the surface; how far residuals are trusted; and
//! which photographs of a texel show what no other predicts (something moved, or does not belong) and so count less.

use super::calibrated::CalibratedObservations;
use super::directional_regression::{Kernel, MAX_PHOTOGRAPHS, Regression, ResidualSample, direction_to_eye};
use super::mirrored::Mirrored;
use super::robust_averaging::Sample;
use crate::photographs::texels::TexelBlocks;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use numerics::upper_median;
use progress::{Cancelled, Progress};
use rayon::prelude::*;

/// α of one photograph for a texel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ResidualCoefficient {
    pub view: u16,
    alpha: [i16; 3],
}

/// By block: results of leave-one-out prediction.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct CrossValidation {
    /// Share of the mirrored part that is modelled as such.
    pub mirrored_share: Vec<f32>,
    /// Confidence in residuals: the factor applied to them.
    pub confidence: Vec<f32>,
    /// Median prediction error, radiance.
    pub errors: Vec<f32>,
}

/// The nonzero residual coefficients of all texels.
#[derive(Debug, PartialEq)]
pub(crate) struct Residuals {
    pub kernel: Kernel,
    pub cross_validation: CrossValidation,
    /// `all[start[t]..start[t + 1]]` belong to texel t.
    pub start: Vec<u32>,
    pub all: Vec<ResidualCoefficient>,
}

/// Quantisation step of α; values beyond 16 do not occur.
const STEP: f32 = 1.0 / 2048.0;
/// Every n-th texel is used to estimate confidence.
const TEXEL_STEP: usize = 4;
/// Every n-th of those is used to select the kernel.
const KERNEL_TEXEL_STEP: usize = 16;
/// Candidate kernels: short, middle and long reach (35°, 60° and 110°, of which half matters), with little and much
/// noise.
const KERNELS: [Kernel; 6] = [
    Kernel { reach: 0.6, noise: 0.1 },
    Kernel { reach: 0.6, noise: 0.5 },
    Kernel { reach: 1.0, noise: 0.1 },
    Kernel { reach: 1.0, noise: 0.5 },
    Kernel { reach: 1.6, noise: 0.1 },
    Kernel { reach: 1.6, noise: 0.5 },
];
/// Errors (radiance) beyond this have bounded influence.
const LARGE_ERROR: f32 = 1.0;
/// A photograph's error is an outlier at this multiple of the usual error.
const OUTLIER_RATIO: f32 = 6.0;
/// Smaller changes of weights are ignored.
const MIN_OUTLIER_SCORE: f32 = 1e-3;
/// Lower bound of errors: 8-bit quantisation and JPEG.
pub(crate) const MIN_ERROR: f32 = 0.006;

impl ResidualCoefficient {
    /// The coefficient of the kernel, linear RGB.
    pub fn alpha(&self) -> Vec3 {
        Vec3::from_array(self.alpha.map(f32::from)) * STEP
    }
}

/// Two models of the light of texels: at the surface alone, and with mirrored surroundings.
pub(crate) struct CandidateModels<'a> {
    pub calibrated: &'a CalibratedObservations<'a>,
    /// Constant part without the mirrored part.
    pub plain: &'a [Vec3],
    /// Constant part beside the mirrored part.
    pub beside_mirrored: &'a [Vec3],
    pub mirrored: &'a Mirrored,
}

/// Scratch space, reused from texel to texel.
pub(crate) struct Workspace {
    regression: Regression,
    pub samples: Vec<Sample>,
    pub residuals: Vec<ResidualSample>,
    pub alpha: Vec<Vec3>,
    predictions: Vec<Vec3>,
}

impl Workspace {
    /// An empty workspace; reused for many texels.
    pub fn new() -> Self {
        let (samples, residuals, alpha, predictions) = Default::default();
        Self { regression: Regression::new(), samples, residuals, alpha, predictions }
    }

    /// Retains the residuals with the largest weights, in their order.
    pub fn retain_best(&mut self) {
        if self.residuals.len() > MAX_PHOTOGRAPHS {
            let mut weights: Vec<f32> = self.residuals.iter().map(|residual| residual.weight).collect();
            weights.sort_unstable_by(|a, b| b.total_cmp(a));
            let cutoff = weights[MAX_PHOTOGRAPHS];
            self.residuals.iter_mut().for_each(|residual| residual.weight -= cutoff);
            self.residuals.retain(|residual| residual.weight > 0.0);
        }
    }

    /// Solves for `alpha` and the leave-one-out prediction of each residual, with this kernel.
    pub fn leave_one_out(&mut self, kernel: &Kernel) {
        self.regression.decompose(kernel, &self.residuals);
        self.leave_one_out_again();
    }

    /// The same for other residuals in the same directions.
    fn leave_one_out_again(&mut self) {
        self.regression.solve(&self.residuals, &mut self.alpha);
        self.regression.leave_one_out(&self.residuals, &self.alpha, &mut self.predictions);
    }

    /// Solves for `alpha`, where `error` is the usual prediction error: photographs that show what no other predicts
    /// get less weight.
    pub fn solve_robustly(&mut self, kernel: &Kernel, error: f32) {
        self.leave_one_out(kernel);
        let outlier_scores: Vec<f32> =
            self.errors().map(|e| (e.length() / (OUTLIER_RATIO * error)).powi(4)).collect();
        if outlier_scores.iter().any(|&outlier_score| outlier_score > MIN_OUTLIER_SCORE) {
            for (residual, outlier_score) in self.residuals.iter_mut().zip(outlier_scores) {
                residual.weight /= 1.0 + outlier_score;
            }
            self.regression.decompose(kernel, &self.residuals);
            self.regression.solve(&self.residuals, &mut self.alpha);
        }
    }

    /// Leave-one-out prediction errors, linear RGB, in the order of the residuals.
    pub fn errors(&self) -> impl Iterator<Item = Vec3> {
        self.residuals
            .iter()
            .zip(&self.predictions)
            .map(|(residual, prediction)| residual.value - *prediction)
    }
}

fn trust(error: Vec3) -> f32 {
    1.0 / (1.0 + error.length_squared() / (LARGE_ERROR * LARGE_ERROR))
}

impl CandidateModels<'_> {
    /// Collects the residuals of a texel when `share` of the mirrored part is modelled as such: at most
    /// [`MAX_PHOTOGRAPHS`].
    fn collect_residuals(&self, texel: usize, share: f32, workspace: &mut Workspace) {
        let Workspace { samples, residuals, .. } = workspace;
        let texels = self.calibrated.texels;
        self.calibrated.collect_samples(texel, samples);
        residuals.clear();
        let from = texels.position(texel);
        let constant = self.plain[texel].lerp(self.beside_mirrored[texel], share);
        let observations = self.calibrated.observations.of_texel(texel);
        for (index, (observation, sample)) in observations.iter().zip(&*samples).enumerate() {
            let direction = direction_to_eye(from, self.calibrated.eye(observation));
            let mirrored = if observation.is_blocked() {
                Vec3::ZERO
            } else {
                self.mirrored.light(texel, texels.shading_normal(texel), direction) * share
            };
            let value = sample.light - constant - mirrored;
            residuals.push(ResidualSample {
                index,
                direction,
                value,
                weight: sample.weight_against(self.plain[texel]),
            });
        }
        workspace.retain_best();
    }

    fn sampled_texels(&self) -> impl IndexedParallelIterator<Item = usize> {
        (0..self.calibrated.texels.count()).into_par_iter().step_by(TEXEL_STEP)
    }

    /// The kernel with the smallest prediction error, with and without the mirrored part.
    fn select_kernel(&self) -> Kernel {
        let errors: Vec<[f32; KERNELS.len()]> = self
            .sampled_texels()
            .step_by(KERNEL_TEXEL_STEP)
            .map_init(Workspace::new, |workspace, texel| {
                let mut errors = [0.0; KERNELS.len()];
                for (error, kernel) in errors.iter_mut().zip(&KERNELS) {
                    for (number, share) in [0.0, 1.0].into_iter().enumerate() {
                        self.collect_residuals(texel, share, workspace);
                        if number == 0 {
                            workspace.leave_one_out(kernel)
                        } else {
                            workspace.leave_one_out_again()
                        }
                        *error += workspace.errors().map(|e| e.length_squared() * trust(e)).sum::<f32>();
                    }
                }
                errors
            })
            .collect();
        let sum = |kernel: usize| errors.iter().map(|errors| f64::from(errors[kernel])).sum::<f64>();
        let best = (0..KERNELS.len()).min_by(|&a, &b| sum(a).total_cmp(&sum(b))).unwrap_or(0);
        KERNELS[best]
    }

    /// By block: the mix of both models with the smallest prediction error.
    fn fit_mirrored_share(&self, blocks: &TexelBlocks, kernel: &Kernel) -> Vec<f32> {
        let sums = self.sum_by_block(blocks, |workspace, texel| {
            self.collect_residuals(texel, 0.0, workspace);
            workspace.leave_one_out(kernel);
            let plain: Vec<Vec3> = workspace.errors().collect();
            self.collect_residuals(texel, 1.0, workspace);
            workspace.leave_one_out_again();
            workspace.errors().zip(plain).zip(&workspace.residuals).fold(
                (0.0, 0.0),
                |(product, square), ((mirrored, plain), residual)| {
                    let trust = residual.weight * trust(plain.min(mirrored));
                    let gained = plain - mirrored;
                    (product + plain.dot(gained) * trust, square + gained.length_squared() * trust)
                },
            )
        });
        blocks.quotients(&sums, [0.0, 1.0])
    }

    /// By block: confidence in residuals, and median prediction error.
    fn fit_confidence(&self, blocks: &TexelBlocks, kernel: &Kernel, share: &[f32]) -> (Vec<f32>, Vec<f32>) {
        let mut errors = vec![Vec::new(); blocks.count()];
        let by_texel: Vec<(BlockSum, Vec<f32>)> = self
            .sampled_texels()
            .map_init(Workspace::new, |workspace, texel| {
                self.collect_residuals(texel, share[texel], workspace);
                workspace.leave_one_out(kernel);
                let sums = workspace.residuals.iter().zip(&workspace.predictions).fold(
                    (0.0, 0.0),
                    |(product, square), (residual, prediction)| {
                        let trust = residual.weight * trust(residual.value - *prediction);
                        (
                            product + residual.value.dot(*prediction) * trust,
                            square + prediction.length_squared() * trust,
                        )
                    },
                );
                let block = blocks.block_of(self.calibrated.texels, texel);
                ((block, sums), workspace.errors().map(Vec3::length).collect())
            })
            .collect();
        let sums = by_texel.into_iter().map(|((block, sums), texel_errors)| {
            errors[block].extend(texel_errors);
            (block, sums)
        });
        let confidence = blocks.quotients(&block_sums(blocks, sums), [0.0, 1.0]);
        let block_median = |errors: &mut Vec<f32>| upper_median(errors).unwrap_or(0.0).max(MIN_ERROR);
        (confidence, errors.iter_mut().map(block_median).collect())
    }

    /// Products and squares of the sampled texels, summed by block.
    fn sum_by_block(
        &self,
        blocks: &TexelBlocks,
        terms: impl Fn(&mut Workspace, usize) -> (f32, f32) + Sync,
    ) -> Vec<(f32, f32)> {
        let by_texel: Vec<(usize, (f32, f32))> = self
            .sampled_texels()
            .map_init(Workspace::new, |workspace, texel| {
                (blocks.block_of(self.calibrated.texels, texel), terms(workspace, texel))
            })
            .collect();
        block_sums(blocks, by_texel.into_iter())
    }

    /// Fits the mirrored share, in [0, 1], by texel, and the residuals.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` asks to stop.
    pub fn fit_residuals(&self, progress: &dyn Progress) -> Result<(Vec<f32>, Residuals), Cancelled> {
        let report_progress = |done| {
            progress.report(done);
            progress.check()
        };
        let texels = self.calibrated.texels;
        let blocks = TexelBlocks::new(texels.size());
        let kernel = self.select_kernel();
        report_progress(0.1)?;
        let block_share = self.fit_mirrored_share(&blocks, &kernel);
        let share = blocks.interpolate_texels(texels, &block_share);
        report_progress(0.25)?;
        let (confidence, errors) = self.fit_confidence(&blocks, &kernel, &share);
        let cross_validation = CrossValidation { mirrored_share: block_share, confidence, errors };
        let confidence = blocks.interpolate_texels(texels, &cross_validation.confidence);
        let errors = blocks.interpolate_texels(texels, &cross_validation.errors);
        report_progress(0.4)?;
        let mut all = vec![ResidualCoefficient::default(); self.calibrated.observations.count()];
        let mut rest = all.as_mut_slice();
        let mut slots = Vec::with_capacity(texels.count());
        for texel in 0..texels.count() {
            let (own, after) = rest.split_at_mut(self.calibrated.observations.range(texel).len());
            slots.push(own);
            rest = after;
        }
        slots.into_par_iter().enumerate().for_each_init(Workspace::new, |workspace, (texel, slots)| {
            if progress.cancelled() {
                return;
            }
            self.collect_residuals(texel, share[texel], workspace);
            let observations = self.calibrated.observations.of_texel(texel);
            for (slot, observation) in slots.iter_mut().zip(observations) {
                slot.view = observation.view;
            }
            if confidence[texel] <= 0.0 {
                return;
            }
            workspace.solve_robustly(&kernel, errors[texel]);
            for (residual, alpha) in workspace.residuals.iter().zip(&workspace.alpha) {
                let steps = (*alpha * (confidence[texel] / STEP)).round();
                slots[residual.index].alpha = steps.to_array().map(|v| v.clamp(-32767.0, 32767.0) as i16);
            }
        });
        let mut start = Vec::with_capacity(texels.count() + 1);
        start.push(0);
        let mut retained = 0;
        for texel in 0..texels.count() {
            for place in self.calibrated.observations.range(texel) {
                if all[place].alpha != [0; 3] {
                    all[retained] = all[place];
                    retained += 1;
                }
            }
            start.push(retained as u32);
        }
        all.truncate(retained);
        all.shrink_to_fit();
        report_progress(1.0)?;
        Ok((share, Residuals { kernel, cross_validation, start, all }))
    }
}

/// A block with a product and a square to be summed over it.
type BlockSum = (usize, (f32, f32));

/// Products and squares, summed by block in their order.
fn block_sums(blocks: &TexelBlocks, terms: impl Iterator<Item = BlockSum>) -> Vec<(f32, f32)> {
    let mut sums = vec![(0.0, 0.0); blocks.count()];
    for (block, (product, square)) in terms {
        sums[block].0 += product;
        sums[block].1 += square;
    }
    sums
}

impl Residuals {
    /// No residuals, for this many texels.
    pub fn none(texels: usize) -> Self {
        Self {
            kernel: KERNELS[0],
            cross_validation: CrossValidation::default(),
            start: vec![0; texels + 1],
            all: Vec::new(),
        }
    }

    /// The coefficients of a texel, in the order of the views.
    pub fn of_texel(&self, texel: usize) -> &[ResidualCoefficient] {
        &self.all[self.start[texel] as usize..self.start[texel + 1] as usize]
    }
}
