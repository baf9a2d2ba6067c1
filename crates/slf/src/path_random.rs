//! Random numbers of paths: the same point gives the same path.

use glam::DVec3;
use scene::SurfacePoint;

/// A stream of uniform numbers in [0, 1).
///
/// The first numbers are points of a Sobol' sequence, Owen-scrambled separately for every seed (Burley 2020), so the
/// paths of one seed are evenly distributed over their first scattering events and lights; then follow independent
/// numbers.
#[derive(Clone, Debug)]
pub(crate) struct PathRandom {
    index: u32,
    seed: u32,
    dimension: u32,
    /// The four dimensions of the sequence that contain the current one.
    batch: [f32; 4],
    state: u64,
}

/// Number of low-discrepancy dimensions: those of the first two scattering events.
const SOBOL_DIMENSIONS: u32 = 24;

impl PathRandom {
    /// The seed for light from a point toward an eye at `eye` (world): the same for the same inputs.
    pub fn seed(point: SurfacePoint, eye: DVec3) -> u64 {
        let numbers = point.barycentric.to_array().into_iter().chain(eye.to_array());
        numbers.fold(mix(u64::from(point.triangle)), |state, number| mix(state ^ number.to_bits()))
    }

    /// The stream of path `index` of a seed: Owen-scrambled Sobol' points.
    pub fn new(seed: u64, index: u32) -> Self {
        // The Sobol' sequence has 2¹⁶ points here; beyond them another scramble is used.
        let scramble = mix(seed ^ u64::from(index >> 16));
        Self {
            index: index & 0xffff,
            seed: scramble as u32,
            dimension: 0,
            batch: [0.0; 4],
            state: mix(seed ^ u64::from(index) << 32),
        }
    }

    /// The next uniform number in [0, 1).
    pub fn next(&mut self) -> f64 {
        if self.dimension < SOBOL_DIMENSIONS {
            let within = self.dimension % 4;
            if within == 0 {
                self.batch = sobol_burley::sample_4d(self.index, self.dimension / 4, self.seed);
            }
            self.dimension += 1;
            return f64::from(self.batch[within as usize]);
        }
        self.state = mix(self.state);
        (self.state >> 11) as f64 / (1u64 << 53) as f64
    }

    /// The next two uniform numbers in [0, 1).
    pub fn next2(&mut self) -> [f64; 2] {
        std::array::from_fn(|_| self.next())
    }

    /// The next three uniform numbers in [0, 1).
    pub fn next3(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.next())
    }
}

/// SplitMix64 (Steele, Lea and Flood 2014).
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
