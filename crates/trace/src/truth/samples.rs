//! Samples of a pixel, and their random numbers: low-discrepancy or independent.
//!
//! A set of samples is a sequence of points in [0, 1)⁴; passes take consecutive pieces of it. With
//! [`Sampler::LowDiscrepancy`] all pixels whose light paint moves use the same sequence (others may have samples of
//! their own kind, [`super::sheared`]). That matters where samples go to other pixels: equal aperture points move
//! all pixels' samples alike, so that where κ varies slowly each pixel gives and takes the same number, and the
//! coverage is even by construction. Drawn apart, the samples that land in a pixel are a random draw from its
//! neighbourhood, with the noise of one (measured: more than twice the samples for the same error). The price is
//! that errors of neighbouring pixels are alike: at few samples they show as steps and repeated dots in place of
//! grain.

use super::options::Sampler;
use crate::random::{hash, mix, unit};
use glam::DVec2;
use std::ops::Range;

/// One sample of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PixelSample {
    /// From the pixel's upper left corner, px.
    pub within_px: DVec2,
    /// The aperture point U, scene units.
    pub u: DVec2,
}

/// Points of one Sobol' sequence: more are not defined.
pub(super) const LONGEST_SEQUENCE: u64 = 1 << 16;

/// Point `index` of the sequence that `seed` names, in [0, 1)⁴.
pub(super) fn point(sampler: Sampler, seed: u64, index: u64) -> [f64; 4] {
    match sampler {
        Sampler::LowDiscrepancy => {
            // Sobol' points, Owen-scrambled (Burley 2020); after 2¹⁶ a new scramble goes on.
            let scramble = hash([seed, index / LONGEST_SEQUENCE]) as u32;
            sobol_burley::sample_4d((index % LONGEST_SEQUENCE) as u32, 0, scramble).map(f64::from)
        }
        Sampler::Independent => {
            let mut state = hash([seed, index]);
            std::array::from_fn(|_| {
                state = mix(state);
                unit(state)
            })
        }
    }
}

/// The points of a range of indices.
pub(super) fn points(sampler: Sampler, seed: u64, range: Range<u64>) -> impl Iterator<Item = [f64; 4]> {
    range.map(move |index| point(sampler, seed, index))
}

/// A rate of samples that need not be whole, dealt out over passes: which indices a pass takes of a source
/// that sends `rate` samples for each sample of a pixel. `passed` are the pixel's samples before and after
/// the pass. Rounded by an offset in [0, 1), so that for offsets evenly spread the mean count is right.
pub(super) fn indices(rate: f64, offset: f64, passed: &Range<u32>) -> Range<u64> {
    let until = |samples: u32| (rate * f64::from(samples) + offset) as u64;
    until(passed.start)..until(passed.end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_of_two_is_stratified_and_seeds_differ() {
        for seed in [0, 1, 77] {
            for first in [0, 64, 192, LONGEST_SEQUENCE] {
                let mut strata = [[0; 64]; 4];
                for point in points(Sampler::LowDiscrepancy, seed, first..first + 64) {
                    (0..4).for_each(|axis| strata[axis][(point[axis] * 64.0) as usize] += 1);
                }
                assert_eq!(strata, [[1; 64]; 4], "seed {seed} from {first}");
            }
        }
        for sampler in [Sampler::LowDiscrepancy, Sampler::Independent] {
            assert_ne!(point(sampler, 0, 0), point(sampler, 1, 0));
            assert_ne!(point(sampler, 0, 5), point(sampler, 0, LONGEST_SEQUENCE + 5));
        }
    }

    #[test]
    fn independent_numbers_are_even_in_every_pair_of_axes() {
        // χ² of 16 × 16 cells, 255 degrees of freedom: mean 255, standard deviation 22.6.
        const COUNT: u64 = 1 << 16;
        for (i, j) in [(0, 1), (0, 2), (1, 3), (2, 3)] {
            let mut cells = [0.0f64; 256];
            for point in points(Sampler::Independent, 9, 0..COUNT) {
                cells[(point[i] * 16.0) as usize * 16 + (point[j] * 16.0) as usize] += 1.0;
            }
            let expected = COUNT as f64 / 256.0;
            let chi_squared: f64 = cells.iter().map(|n| (n - expected).powi(2) / expected).sum();
            assert!((chi_squared - 255.0).abs() < 4.0 * 22.6, "axes {i}, {j}: {chi_squared}");
        }
    }

    #[test]
    fn rates_are_kept_over_passes() {
        for rate in [0.0, 0.013, 0.7, 1.0, 37.3] {
            let mut next = 0;
            let mut mean = 0.0;
            for k in 0..100 {
                let offset = (f64::from(k) + 0.5) / 100.0;
                next = 0;
                for pass in [0..3, 3..64, 64..65] {
                    let range = indices(rate, offset, &pass);
                    assert_eq!(range.start, next, "no index twice, none left out");
                    next = range.end;
                }
                mean += next as f64 / 100.0;
            }
            assert!((mean - rate * 65.0).abs() < 1e-2, "rate {rate}: {mean}, last {next}");
        }
    }
}
