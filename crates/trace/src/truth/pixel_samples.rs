//! The samples of a pixel: position within it and on the aperture.
//!
//! Every pixel uses the same ones. That matters where paint moves samples to other pixels: equal aperture
//! points move all pixels' samples alike, so that where κ varies slowly each pixel gives and takes the same
//! number, and the coverage is even by construction. Drawn apart, the samples that land in a pixel are a
//! random draw from its neighbourhood, with the noise of one (measured: more than twice the samples for the
//! same error). The price is that errors of neighbouring pixels are alike: at few samples they show as steps
//! and repeated dots in place of grain.

use glam::DVec2;
use lens::{ApertureSampler, Camera};

/// One sample of every pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PixelSample {
    /// From the pixel's upper left corner, px.
    pub within_px: DVec2,
    /// The aperture point U, scene units.
    pub u: DVec2,
}

/// Points of one Sobol' sequence: more are not defined.
pub(super) const LONGEST_SEQUENCE: u32 = 1 << 16;

/// The samples of each pixel, in batches that fit into memory.
pub(super) fn batches(
    camera: &Camera,
    samples: u32,
    seed: u32,
) -> impl ExactSizeIterator<Item = Vec<PixelSample>> {
    let aperture = ApertureSampler::new(&camera.aperture);
    let radius = camera.aperture_radius;
    let count = samples.div_ceil(LONGEST_SEQUENCE);
    (0..count as usize).map(move |batch| {
        let rest = samples - batch as u32 * LONGEST_SEQUENCE;
        let sample = |[x, y, a, b]: [f64; 4]| PixelSample {
            within_px: DVec2::new(x, y),
            u: aperture.sample(a, b) * radius,
        };
        points(rest.min(LONGEST_SEQUENCE), [seed, batch as u32, 0]).map(sample).collect()
    })
}

/// The first `count` ≤ 2¹⁶ points of a Sobol' sequence over [0, 1)⁴, Owen-scrambled (Burley 2020) by a seed
/// of three words.
pub(super) fn points(count: u32, seed: [u32; 3]) -> impl Iterator<Item = [f64; 4]> {
    let scramble = seed.into_iter().fold(0, |hash, word| mix(hash ^ word));
    (0..count).map(move |index| sobol_burley::sample_4d(index, 0, scramble).map(f64::from))
}

/// A bijective mix of 32 bits ("lowbias32", Wellons 2018), preceded by an addition so that 0 is mixed as
/// well.
fn mix(x: u32) -> u32 {
    let x = x.wrapping_add(0x9e37_79b9);
    let x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lens::ApertureShape;

    fn camera() -> Camera {
        Camera { aperture: ApertureShape::Square.into(), aperture_radius: 0.5, ..Camera::default() }
    }

    #[test]
    fn a_power_of_two_is_stratified_and_seeds_differ() {
        for seed in [0, 1, 77] {
            let batches: Vec<_> = batches(&camera(), 64, seed).collect();
            assert_eq!(batches.len(), 1);
            let mut strata = [[0; 64]; 4];
            for PixelSample { within_px, u } in &batches[0] {
                let point = [within_px.x, within_px.y, u.x + 0.5, u.y + 0.5];
                (0..4).for_each(|axis| strata[axis][(point[axis] * 64.0) as usize] += 1);
            }
            assert_eq!(strata, [[1; 64]; 4]);
        }
        let first = |seed| batches(&camera(), 1, seed).next();
        assert_ne!(first(0), first(1));
    }

    #[test]
    fn more_samples_than_a_sequence_has_go_on() {
        let batches: Vec<_> = batches(&camera(), (1 << 17) + 5, 3).collect();
        assert_eq!(batches.iter().map(Vec::len).collect::<Vec<_>>(), [1 << 16, 1 << 16, 5]);
        assert_ne!(batches[0][0], batches[1][0]);
    }
}
