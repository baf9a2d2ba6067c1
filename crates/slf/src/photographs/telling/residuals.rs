//! What remains toward each photograph when constant and mirrored parts are taken away, and how much of all of it is believed.
//!
//! Leaving a photograph out tells (`directions`): which kernel; by blocks of texels, whether what is mirrored is better told by the
//! surroundings or, as all other light, at the surface; what of a residual is believed; and which photographs of a texel show what no
//! other leads to expect, so that they count less (what moved, or does not belong).

use super::calibrated::Calibrated;
use super::constant::Sample;
use super::directions::{Kernel, Known, MOST, Regression, toward};
use super::mirrored::Mirrored;
use crate::photographs::numbers::median;
use crate::photographs::places::Blocks;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use progress::{Cancelled, Progress};
use rayon::prelude::*;

/// α of a photograph and texel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Residual {
    pub view: u16,
    alpha: [i16; 3],
}

/// By block, what leaving out told of the residuals.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Believed {
    /// How much of what is mirrored is told as such.
    pub share: Vec<f32>,
    /// How much of the residuals is believed.
    pub belief: Vec<f32>,
    /// What leaving out finds wrong, the median.
    pub errors: Vec<f32>,
}

/// The residuals of all texels, those that are 0 left out.
#[derive(Debug, PartialEq)]
pub(crate) struct Residuals {
    pub kernel: Kernel,
    pub believed: Believed,
    /// `all[start[t]..start[t + 1]]` are of texel t.
    pub start: Vec<u32>,
    pub all: Vec<Residual>,
}

/// α is kept by steps of this; larger ones than 16 do not occur.
const STEP: f32 = 1.0 / 2048.0;
/// One texel of so many is asked what to believe.
const ASKED: usize = 4;
/// One of so many of those is asked for the kernel.
const ASKED_FOR_KERNEL: usize = 16;
/// The kernels that are tried: a wide, a middle and a narrow reach (35°, 60° and 110°, of which half is felt), much and little noise.
const KERNELS: [Kernel; 6] = [
    Kernel { reach: 0.6, noise: 0.1 },
    Kernel { reach: 0.6, noise: 0.5 },
    Kernel { reach: 1.0, noise: 0.1 },
    Kernel { reach: 1.0, noise: 0.5 },
    Kernel { reach: 1.6, noise: 0.1 },
    Kernel { reach: 1.6, noise: 0.5 },
];
/// Errors (radiance) beyond this say little more than that they are large.
const LARGE: f32 = 1.0;
/// Errors of a photograph so many times those around are thought to be of what does not belong.
const ODD: f32 = 6.0;
/// Weights that would change by less stay what they are.
const NOT_ODD: f32 = 1e-3;
/// Errors are thought to be no smaller: 8 bits and JPEG.
pub(crate) const LEAST_ERROR: f32 = 0.006;

impl Residual {
    pub fn alpha(&self) -> Vec3 {
        Vec3::from_array(self.alpha.map(f32::from)) * STEP
    }
}

/// Two ways to tell the light of texels: at the surface alone, and with what is mirrored.
pub(crate) struct Ways<'a> {
    pub radiance: &'a Calibrated<'a>,
    /// The constant part where nothing is mirrored.
    pub plain: &'a [Vec3],
    /// The constant part beside what is mirrored.
    pub beside_mirrored: &'a [Vec3],
    pub mirrored: &'a Mirrored,
}

/// What is worked with for one place after the other.
pub(crate) struct Work {
    regression: Regression,
    pub samples: Vec<Sample>,
    pub known: Vec<Known>,
    pub alpha: Vec<Vec3>,
    told: Vec<Vec3>,
}

impl Work {
    pub fn new() -> Self {
        let (samples, known, alpha, told) = Default::default();
        Self { regression: Regression::new(), samples, known, alpha, told }
    }

    /// Leaves the best seen of what is known, in their order.
    pub fn keep_best(&mut self) {
        if self.known.len() > MOST {
            let mut weights: Vec<f32> = self.known.iter().map(|known| known.weight).collect();
            weights.sort_unstable_by(|a, b| b.total_cmp(a));
            let least = weights[MOST];
            self.known.iter_mut().for_each(|known| known.weight -= least);
            self.known.retain(|known| known.weight > 0.0);
        }
    }

    /// Solves for the residuals of `known`, and what each would be by the others.
    pub fn leave_out(&mut self, kernel: &Kernel) {
        self.regression.decompose(kernel, &self.known);
        self.leave_out_again();
    }

    /// The same of other residuals in the same directions.
    fn leave_out_again(&mut self) {
        self.regression.solve(&self.known, &mut self.alpha);
        self.regression.left_out(&self.known, &self.alpha, &mut self.told);
    }

    /// Solves for the residuals of `known`, into `alpha`, where leaving out usually finds such an `error` wrong: what shows what no other
    /// leads to expect counts less.
    pub fn solve_without_odd(&mut self, kernel: &Kernel, error: f32) {
        self.leave_out(kernel);
        let odds: Vec<f32> = self.errors().map(|e| (e.length() / (ODD * error)).powi(4)).collect();
        if odds.iter().any(|&odd| odd > NOT_ODD) {
            for (known, odd) in self.known.iter_mut().zip(odds) {
                known.weight /= 1.0 + odd;
            }
            self.regression.decompose(kernel, &self.known);
            self.regression.solve(&self.known, &mut self.alpha);
        }
    }

    /// What leaving out finds wrong.
    pub fn errors(&self) -> impl Iterator<Item = Vec3> {
        self.known.iter().zip(&self.told).map(|(known, told)| known.residual - *told)
    }
}

fn trust(error: Vec3) -> f32 {
    1.0 / (1.0 + error.length_squared() / (LARGE * LARGE))
}

impl Ways<'_> {
    /// What is known of a texel's residual, `share` of what is mirrored told as such: at most [`MOST`].
    fn know(&self, texel: usize, share: f32, work: &mut Work) {
        let Work { samples, known, .. } = work;
        let texels = self.radiance.texels;
        self.radiance.samples_into(texel, samples);
        known.clear();
        let from = texels.position(texel);
        let constant = self.plain[texel].lerp(self.beside_mirrored[texel], share);
        let sightings = self.radiance.sightings.of_texel(texel);
        for (place, (sighting, sample)) in sightings.iter().zip(&*samples).enumerate() {
            let direction = toward(from, self.radiance.eye(sighting));
            let mirrored = if sighting.is_blocked() {
                Vec3::ZERO
            } else {
                self.mirrored.at(texel, texels.shading_normal(texel), direction) * share
            };
            let residual = sample.light - constant - mirrored;
            known.push(Known { place, direction, residual, weight: sample.counts(self.plain[texel]) });
        }
        work.keep_best();
    }

    fn asked(&self) -> impl IndexedParallelIterator<Item = usize> {
        (0..self.radiance.texels.count()).into_par_iter().step_by(ASKED)
    }

    /// The kernel by which photographs left out are told best, with or without what is mirrored.
    fn kernel(&self) -> Kernel {
        let errors: Vec<[f32; KERNELS.len()]> = self
            .asked()
            .step_by(ASKED_FOR_KERNEL)
            .map_init(Work::new, |work, texel| {
                let mut errors = [0.0; KERNELS.len()];
                for (error, kernel) in errors.iter_mut().zip(&KERNELS) {
                    for (number, share) in [0.0, 1.0].into_iter().enumerate() {
                        self.know(texel, share, work);
                        if number == 0 {
                            work.leave_out(kernel)
                        } else {
                            work.leave_out_again()
                        }
                        *error += work.errors().map(|e| e.length_squared() * trust(e)).sum::<f32>();
                    }
                }
                errors
            })
            .collect();
        let sum = |kernel: usize| errors.iter().map(|errors| f64::from(errors[kernel])).sum::<f64>();
        let best = (0..KERNELS.len()).min_by(|&a, &b| sum(a).total_cmp(&sum(b))).unwrap_or(0);
        KERNELS[best]
    }

    /// By block, how much of what is mirrored is told as such: the mix of both ways whose errors are least.
    fn mirrored_share(&self, blocks: &Blocks, kernel: &Kernel) -> Vec<f32> {
        let sums = self.sums(blocks, |work, texel| {
            self.know(texel, 0.0, work);
            work.leave_out(kernel);
            let plain: Vec<Vec3> = work.errors().collect();
            self.know(texel, 1.0, work);
            work.leave_out_again();
            work.errors().zip(plain).zip(&work.known).fold(
                (0.0, 0.0),
                |(product, square), ((mirrored, plain), known)| {
                    let trust = known.weight * trust(plain.min(mirrored));
                    let gained = plain - mirrored;
                    (product + plain.dot(gained) * trust, square + gained.length_squared() * trust)
                },
            )
        });
        blocks.quotients(&sums, [0.0, 1.0])
    }

    /// By block, how much of the residuals is believed, and the median of what leaving out finds wrong.
    fn belief_and_errors(&self, blocks: &Blocks, kernel: &Kernel, share: &[f32]) -> (Vec<f32>, Vec<f32>) {
        let mut errors = vec![Vec::new(); blocks.count()];
        let found: Vec<(OfBlock, Vec<f32>)> = self
            .asked()
            .map_init(Work::new, |work, texel| {
                self.know(texel, share[texel], work);
                work.leave_out(kernel);
                let sums =
                    work.known.iter().zip(&work.told).fold((0.0, 0.0), |(product, square), (known, told)| {
                        let trust = known.weight * trust(known.residual - *told);
                        (product + known.residual.dot(*told) * trust, square + told.length_squared() * trust)
                    });
                let block = blocks.of_texel(self.radiance.texels, texel);
                ((block, sums), work.errors().map(Vec3::length).collect())
            })
            .collect();
        let sums = found.into_iter().map(|((block, sums), found)| {
            errors[block].extend(found);
            (block, sums)
        });
        let belief = blocks.quotients(&joined(blocks, sums), [0.0, 1.0]);
        let middle = |errors: &mut Vec<f32>| median(errors, f32::total_cmp).unwrap_or(0.0).max(LEAST_ERROR);
        (belief, errors.iter_mut().map(middle).collect())
    }

    /// Products and squares of asked texels, by block.
    fn sums(&self, blocks: &Blocks, of: impl Fn(&mut Work, usize) -> (f32, f32) + Sync) -> Vec<(f32, f32)> {
        let found: Vec<(usize, (f32, f32))> = self
            .asked()
            .map_init(Work::new, |work, texel| {
                (blocks.of_texel(self.radiance.texels, texel), of(work, texel))
            })
            .collect();
        joined(blocks, found.into_iter())
    }

    /// How much of what is mirrored is told as such, by texel, and the residuals.
    pub fn residuals(&self, progress: &dyn Progress) -> Result<(Vec<f32>, Residuals), Cancelled> {
        let passed = |done| {
            progress.report(done);
            progress.check()
        };
        let texels = self.radiance.texels;
        let blocks = Blocks::of(texels.size());
        let kernel = self.kernel();
        passed(0.1)?;
        let share_of_block = self.mirrored_share(&blocks, &kernel);
        let share = blocks.by_texel(texels, &share_of_block);
        passed(0.25)?;
        let (belief, errors) = self.belief_and_errors(&blocks, &kernel, &share);
        let believed = Believed { share: share_of_block, belief, errors };
        let belief = blocks.by_texel(texels, &believed.belief);
        let errors = blocks.by_texel(texels, &believed.errors);
        passed(0.4)?;
        let mut all = vec![Residual::default(); self.radiance.sightings.count()];
        let mut rest = all.as_mut_slice();
        let mut slots = Vec::with_capacity(texels.count());
        for texel in 0..texels.count() {
            let (own, after) = rest.split_at_mut(self.radiance.sightings.range(texel).len());
            slots.push(own);
            rest = after;
        }
        slots.into_par_iter().enumerate().for_each_init(Work::new, |work, (texel, slots)| {
            if progress.cancelled() {
                return;
            }
            self.know(texel, share[texel], work);
            let sightings = self.radiance.sightings.of_texel(texel);
            for (slot, sighting) in slots.iter_mut().zip(sightings) {
                slot.view = sighting.view;
            }
            if belief[texel] <= 0.0 {
                return;
            }
            work.solve_without_odd(&kernel, errors[texel]);
            for (known, alpha) in work.known.iter().zip(&work.alpha) {
                let steps = (*alpha * (belief[texel] / STEP)).round();
                slots[known.place].alpha = steps.to_array().map(|v| v.clamp(-32767.0, 32767.0) as i16);
            }
        });
        let mut start = Vec::with_capacity(texels.count() + 1);
        start.push(0);
        let mut kept = 0;
        for texel in 0..texels.count() {
            for place in self.radiance.sightings.range(texel) {
                if all[place].alpha != [0; 3] {
                    all[kept] = all[place];
                    kept += 1;
                }
            }
            start.push(kept as u32);
        }
        all.truncate(kept);
        all.shrink_to_fit();
        passed(1.0)?;
        Ok((share, Residuals { kernel, believed, start, all }))
    }
}

/// A block, and a product and a square that are summed over it.
type OfBlock = (usize, (f32, f32));

/// Products and squares, summed by block in their order.
fn joined(blocks: &Blocks, found: impl Iterator<Item = OfBlock>) -> Vec<(f32, f32)> {
    let mut sums = vec![(0.0, 0.0); blocks.count()];
    for (block, (product, square)) in found {
        sums[block].0 += product;
        sums[block].1 += square;
    }
    sums
}

impl Residuals {
    /// Of so many texels, which have none.
    pub fn none(texels: usize) -> Self {
        Self {
            kernel: KERNELS[0],
            believed: Believed::default(),
            start: vec![0; texels + 1],
            all: Vec::new(),
        }
    }

    pub fn of_texel(&self, texel: usize) -> &[Residual] {
        &self.all[self.start[texel] as usize..self.start[texel + 1] as usize]
    }
}
