//! The samples of a pixel: position within it and on the aperture.

/// An endless sequence of points of [0, 1)⁴: pixel x and y, aperture a and b.
///
/// An Owen-scrambled Sobol' sequence (Burley 2020), scrambled apart for each pixel. It is defined for 2¹⁶ points; after those a
/// new scramble begins.
pub(super) struct PixelSamples {
    seed: u32,
    index: u32,
}

/// Points of one scramble.
const LONGEST_SEQUENCE: u32 = 1 << 16;

impl PixelSamples {
    /// The samples of pixel (x, y), which may lie outside of the frame.
    pub fn new(x: i64, y: i64, seed: u32) -> Self {
        Self { seed: mix(mix(mix(seed) ^ x as u32) ^ y as u32), index: 0 }
    }
}

impl Iterator for PixelSamples {
    type Item = [f64; 4];

    fn next(&mut self) -> Option<[f64; 4]> {
        if self.index == LONGEST_SEQUENCE {
            (self.index, self.seed) = (0, mix(self.seed));
        }
        let point = sobol_burley::sample_4d(self.index, 0, self.seed);
        self.index += 1;
        Some(point.map(f64::from))
    }
}

/// A bijective mix of 32 bits ("lowbias32", Wellons 2018), preceded by an addition so that 0 is mixed as well.
fn mix(x: u32) -> u32 {
    let x = x.wrapping_add(0x9e37_79b9);
    let x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_of_two_is_stratified_and_pixels_differ() {
        for pixel in [(0, 0), (-3, 7)] {
            let mut strata = [[0; 64]; 4];
            for point in PixelSamples::new(pixel.0, pixel.1, 5).take(64) {
                (0..4).for_each(|axis| strata[axis][(point[axis] * 64.0) as usize] += 1);
            }
            assert_eq!(strata, [[1; 64]; 4]);
        }
        let first = |x, y, seed| PixelSamples::new(x, y, seed).next();
        assert_ne!(first(0, 1, 0), first(1, 0, 0));
        assert_ne!(first(0, 0, 0), first(0, 0, 1));
    }

    #[test]
    fn more_samples_than_a_sequence_has_go_on() {
        let after: Vec<_> = PixelSamples::new(1, 2, 3).skip((1 << 16) - 1).take(3).collect();
        assert!(after.iter().flatten().all(|x| (0.0..1.0).contains(x)));
        assert_ne!(after[1], PixelSamples::new(1, 2, 3).next().unwrap());
    }
}
