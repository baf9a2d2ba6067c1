//! What remains toward each photograph when constant and mirrored parts are taken away, and how much of all of it is believed.
//!
//! Leaving a photograph out tells (`directions`): which kernel; by blocks of texels, whether what is mirrored is better told by the
//! surroundings or, as all other light, at the surface; what of a residual is believed; and which photographs of a texel show what no
//! other leads to expect, so that they count less (what moved, or does not belong).

use super::blocks::Blocks;
use super::calibrated::Calibrated;
use super::constant::Sample;
use super::directions::{Kernel, Known, MOST, Regression, toward};
use super::median::median;
use super::mirrored::Mirrored;
use glam::Vec3;
use rayon::prelude::*;

/// α of a photograph and texel.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Residual {
    pub view: u16,
    alpha: [i16; 3],
}

/// The residuals of all texels.
pub(crate) struct Residuals {
    pub kernel: Kernel,
    /// `all[start[t]..start[t + 1]]` are of texel t.
    start: Vec<u32>,
    all: Vec<Residual>,
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
/// Errors are thought to be no smaller: 8 bits and JPEG.
const LEAST_ERROR: f32 = 0.006;

impl Residual {
    pub fn alpha(&self) -> Vec3 {
        Vec3::from_array(self.alpha.map(f32::from)) * STEP
    }
}

/// Two ways to tell the light of texels: at the surface alone, and with what is mirrored.
pub(crate) struct Told<'a> {
    pub radiance: &'a Calibrated<'a>,
    /// The constant part where nothing is mirrored.
    pub plain: &'a [Vec3],
    /// The constant part beside what is mirrored.
    pub beside_mirrored: &'a [Vec3],
    pub mirrored: &'a Mirrored,
}

/// What is worked with for one texel after the other.
struct Work {
    regression: Regression,
    samples: Vec<Sample>,
    known: Vec<Known>,
    alpha: Vec<Vec3>,
    told: Vec<Vec3>,
}

impl Work {
    fn new() -> Self {
        let (samples, known, alpha, told) = Default::default();
        Self { regression: Regression::new(), samples, known, alpha, told }
    }

    /// Solves for the residuals of `known`, and what each would be by the others.
    fn leave_out(&mut self, kernel: &Kernel) {
        self.regression.solve(kernel, &self.known, &mut self.alpha);
        self.regression.left_out(&self.known, &self.alpha, &mut self.told);
    }

    /// What leaving out finds wrong.
    fn errors(&self) -> impl Iterator<Item = Vec3> {
        self.known.iter().zip(&self.told).map(|(known, told)| known.residual - *told)
    }
}

fn trust(error: Vec3) -> f32 {
    1.0 / (1.0 + error.length_squared() / (LARGE * LARGE))
}

impl Told<'_> {
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
            let mirrored = self.mirrored.at(texel, texels.shading_normal(texel), direction) * share;
            let residual = sample.light - constant - mirrored;
            known.push(Known { place, direction, residual, weight: sample.weight });
        }
        if known.len() > MOST {
            // The best seen, in their order.
            let mut weights: Vec<f32> = known.iter().map(|known| known.weight).collect();
            weights.sort_unstable_by(|a, b| b.total_cmp(a));
            let least = weights[MOST];
            known.iter_mut().for_each(|known| known.weight -= least);
            known.retain(|known| known.weight > 0.0);
        }
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
                for share in [0.0, 1.0] {
                    self.know(texel, share, work);
                    for (error, kernel) in errors.iter_mut().zip(&KERNELS) {
                        work.leave_out(kernel);
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
            work.leave_out(kernel);
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

    /// By block, how much of the residuals is believed.
    fn belief(&self, blocks: &Blocks, kernel: &Kernel, share: &[f32]) -> Vec<f32> {
        let sums = self.sums(blocks, |work, texel| {
            self.know(texel, share[texel], work);
            work.leave_out(kernel);
            work.known.iter().zip(&work.told).fold((0.0, 0.0), |(product, square), (known, told)| {
                let trust = known.weight * trust(known.residual - *told);
                (product + known.residual.dot(*told) * trust, square + told.length_squared() * trust)
            })
        });
        blocks.quotients(&sums, [0.0, 1.0])
    }

    /// By block, the median of what leaving out finds wrong.
    fn errors(&self, blocks: &Blocks, kernel: &Kernel, share: &[f32]) -> Vec<f32> {
        let found: Vec<(usize, Vec<f32>)> = self
            .asked()
            .map_init(Work::new, |work, texel| {
                self.know(texel, share[texel], work);
                work.leave_out(kernel);
                (blocks.of_texel(self.radiance.texels, texel), work.errors().map(Vec3::length).collect())
            })
            .collect();
        let mut errors = vec![Vec::new(); blocks.count()];
        for (block, found) in found {
            errors[block].extend(found);
        }
        let middle = |errors: &mut Vec<f32>| median(errors, f32::total_cmp).unwrap_or(0.0).max(LEAST_ERROR);
        errors.iter_mut().map(middle).collect()
    }

    /// Products and squares of asked texels, by block.
    fn sums(&self, blocks: &Blocks, of: impl Fn(&mut Work, usize) -> (f32, f32) + Sync) -> Vec<(f32, f32)> {
        let found: Vec<(usize, (f32, f32))> = self
            .asked()
            .map_init(Work::new, |work, texel| {
                (blocks.of_texel(self.radiance.texels, texel), of(work, texel))
            })
            .collect();
        let mut sums = vec![(0.0, 0.0); blocks.count()];
        for (block, (product, square)) in found {
            sums[block].0 += product;
            sums[block].1 += square;
        }
        sums
    }

    /// How much of what is mirrored is told as such, by texel, and the residuals.
    pub fn residuals(&self) -> (Vec<f32>, Residuals) {
        let texels = self.radiance.texels;
        let blocks = Blocks::of(texels);
        let kernel = self.kernel();
        let by_texel = |values: Vec<f32>| -> Vec<f32> {
            (0..texels.count()).into_par_iter().map(|texel| blocks.at(texels, texel, &values)).collect()
        };
        let share = by_texel(self.mirrored_share(&blocks, &kernel));
        let belief = by_texel(self.belief(&blocks, &kernel, &share));
        let errors = by_texel(self.errors(&blocks, &kernel, &share));
        let mut all = vec![Residual::default(); self.radiance.sightings.count()];
        let mut rest = all.as_mut_slice();
        let mut slots = Vec::with_capacity(texels.count());
        for texel in 0..texels.count() {
            let (own, after) = rest.split_at_mut(self.radiance.sightings.range(texel).len());
            slots.push(own);
            rest = after;
        }
        slots.into_par_iter().enumerate().for_each_init(Work::new, |work, (texel, slots)| {
            self.know(texel, share[texel], work);
            let sightings = self.radiance.sightings.of_texel(texel);
            for (slot, sighting) in slots.iter_mut().zip(sightings) {
                slot.view = sighting.view;
            }
            if belief[texel] <= 0.0 {
                return;
            }
            work.leave_out(&kernel);
            let odd: Vec<f32> = work.errors().map(|error| error.length() / (ODD * errors[texel])).collect();
            for (known, odd) in work.known.iter_mut().zip(odd) {
                known.weight /= 1.0 + odd.powi(4);
            }
            work.regression.solve(&kernel, &work.known, &mut work.alpha);
            for (known, alpha) in work.known.iter().zip(&work.alpha) {
                let steps = (*alpha * (belief[texel] / STEP)).round();
                slots[known.place].alpha = steps.to_array().map(|v| v.clamp(-32767.0, 32767.0) as i16);
            }
        });
        let start = (0..=texels.count())
            .map(|t| if t == 0 { 0 } else { self.radiance.sightings.range(t - 1).end as u32 });
        (share, Residuals { kernel, start: start.collect(), all })
    }
}

impl Residuals {
    pub fn of_texel(&self, texel: usize) -> &[Residual] {
        &self.all[self.start[texel] as usize..self.start[texel + 1] as usize]
    }
}
