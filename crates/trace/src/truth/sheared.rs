//! Samples that are evenly spread where an edge is decided.
//!
//! A sample of a pixel has four numbers, its place x on the pixel and its aperture point U. But whether its ray
//! passes an edge of depth z, or which spot of a texture of that depth it meets, depends on two alone: where the
//! ray crosses that depth, which seen from the middle of the aperture is
//!
//! ```text
//! w = x − r·U/R        r the signed radius of the circle of confusion of depth z, px
//! ```
//!
//! Four-dimensional points of low discrepancy are no better than N^(−5/8) at such edges, and no set of points
//! spreads w evenly for all r at once. For a given r it is easy: a pool of points is put in order along
//! Hilbert's curve over w, and samples are taken from equal pieces of that order, by the scrambled van der Corput
//! sequence (extensible grids on a space-filling curve: He and Owen 2016). Errors at edges then fall with
//! N^(−3/4), as in focus, whatever the circle. The order is one of a few hundred, for radii so close that what
//! lies between costs little ([`Level`]); [`super::survey`] chooses each pixel's.
//!
//! Every sample is evenly distributed over pixel and aperture whatever the order, so no choice makes a bias, if
//! only it is made without regard to the samples' own values.

use super::from_sensor::PixelSample;
use super::options::Sampler;
use super::samples::{self, LONGEST_SEQUENCE};
use crate::random::hash;
use glam::DVec2;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// A radius of the circle of confusion, rounded: in steps of 0.04 px up to a pixel, of 4 % from there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Level(i16);

impl Level {
    /// In focus.
    pub const SHARP: Self = Self(0);
    /// Larger radii than this level's, 11,000 px, count as that.
    const LARGEST: i16 = 250;
    /// How many there are.
    pub const COUNT: usize = 2 * Self::LARGEST as usize + 1;
    const STEP: f64 = 0.04;

    /// The one nearest to a signed radius, px.
    pub fn of(radius_px: f64) -> Self {
        let largest = f64::from(Self::LARGEST);
        Self((radius_px.asinh() / Self::STEP).round().clamp(-largest, largest) as i16)
    }

    /// Its signed radius, px.
    pub fn radius_px(self) -> f64 {
        (f64::from(self.0) * Self::STEP).sinh()
    }

    /// Whether two levels may be those of one surface.
    pub fn is_near(self, other: Self) -> bool {
        (self.0 - other.0).abs() <= 2
    }

    /// Its number among all, below [`Self::COUNT`].
    pub fn index(self) -> usize {
        (self.0 + Self::LARGEST) as usize
    }
}

/// The points of the pool for each sample that is wanted: its own error must be small beside that of a choice of
/// so many.
const POOL: u64 = 16;

/// Sequences of samples, one for each of a few levels.
pub(super) struct Sheared {
    seed: u64,
    /// Points of a pool, a power of two. After so many samples another pool goes on.
    size: u64,
    levels: Vec<Level>,
    latest: Mutex<Option<Arc<Pool>>>,
}

/// Points, and their orders by level.
struct Pool {
    number: u64,
    points: Vec<PixelSample>,
    orders: Vec<Vec<u32>>,
}

impl Sheared {
    /// Sequences for `levels`, of which about `samples_per_pixel` samples are wanted.
    pub fn new(seed: u64, samples_per_pixel: u32, levels: Vec<Level>) -> Self {
        let size = (POOL * u64::from(samples_per_pixel)).next_power_of_two().min(LONGEST_SEQUENCE);
        Self { seed, size, levels, latest: Mutex::new(None) }
    }

    /// Of every level the samples `passed`; `sample` makes one of four numbers.
    pub fn samples(
        &self,
        passed: &Range<u32>,
        aperture_radius: f64,
        sample: impl Fn([f64; 4]) -> PixelSample,
    ) -> Vec<Vec<PixelSample>> {
        let mut samples = vec![Vec::with_capacity(passed.len()); self.levels.len()];
        let (mut from, end) = (u64::from(passed.start), u64::from(passed.end));
        while from < end {
            let number = from / self.size;
            let pool = self.pool(number, aperture_radius, &sample);
            let until = end.min((number + 1) * self.size);
            let scramble = hash([self.seed, RANKS, number]) as u32;
            for index in from..until {
                let along = sobol_burley::sample((index % self.size) as u32, 0, scramble);
                let rank = (f64::from(along) * self.size as f64) as usize;
                for (samples, order) in samples.iter_mut().zip(&pool.orders) {
                    samples.push(pool.points[order[rank] as usize]);
                }
            }
            from = until;
        }
        samples
    }

    fn pool(&self, number: u64, aperture_radius: f64, sample: impl Fn([f64; 4]) -> PixelSample) -> Arc<Pool> {
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pool) = latest.as_ref().filter(|pool| pool.number == number) {
            return pool.clone();
        }
        let indices = number * self.size..(number + 1) * self.size;
        let seed = hash([self.seed, POINTS]);
        let points: Vec<_> = samples::points(Sampler::LowDiscrepancy, seed, indices).map(sample).collect();
        let orders = self.levels.par_iter().map(|&level| order(&points, level, aperture_radius)).collect();
        latest.insert(Arc::new(Pool { number, points, orders })).clone()
    }
}

/// Tell the seeds of the pools' points and of the ranks that samples take from others.
const POINTS: u64 = 1;
const RANKS: u64 = 2;

/// The indices of `pool` in the order of Hilbert's curve over w; `aperture_radius` in scene units.
pub(super) fn order(pool: &[PixelSample], level: Level, aperture_radius: f64) -> Vec<u32> {
    let radius = level.radius_px();
    let half = radius.abs() + 0.5;
    let steps = f64::from(1 << HILBERT_BITS);
    let place = |sample: &PixelSample| {
        // The picture's y is down, the aperture's is up.
        let u = if aperture_radius > 0.0 { sample.u / aperture_radius } else { DVec2::ZERO };
        let w = sample.within_px - 0.5 - radius * DVec2::new(u.x, -u.y);
        // `as` saturates: what lies on the border stays inside.
        let [x, y] =
            ((w / half + 1.0) / 2.0 * steps).to_array().map(|c| (c as u32).min((1 << HILBERT_BITS) - 1));
        along_hilbert(x, y)
    };
    let places: Vec<u32> = pool.iter().map(place).collect();
    let mut order: Vec<u32> = (0..pool.len() as u32).collect();
    order.sort_by_key(|&k| places[k as usize]);
    order
}

/// Bits of a coordinate on the curve.
const HILBERT_BITS: u32 = 16;

/// How far along Hilbert's curve the cell (x, y) of 2¹⁶ × 2¹⁶ lies.
fn along_hilbert(mut x: u32, mut y: u32) -> u32 {
    let mut along = 0;
    for bit in (0..HILBERT_BITS).rev() {
        let side = 1u32 << bit;
        let (right, down) = (u32::from(x & side != 0), u32::from(y & side != 0));
        along = along << 2 | ((3 * right) ^ down);
        // Turned so that each quarter's curve begins where the one before it ends.
        if down == 0 {
            if right == 1 {
                (x, y) = (!x, !y);
            }
            (x, y) = (y, x);
        }
    }
    along
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_lie_close_and_reach_far() {
        for radius in [0.0, 0.01, -0.5, 1.0, -3.0, 40.0, -1e3, 1e4] {
            let level = Level::of(radius);
            assert!((level.radius_px() - radius).abs() <= 0.0201 * radius.hypot(1.0), "{radius}");
            assert!(level.index() < Level::COUNT);
            assert_eq!(Level::of(level.radius_px()), level);
        }
        assert_eq!(Level::of(0.0), Level::SHARP);
        assert_eq!(Level::of(f64::INFINITY).index(), Level::COUNT - 1);
        assert_eq!(Level::of(f64::NEG_INFINITY).index(), 0);
    }

    #[test]
    fn neighbours_on_the_curve_are_neighbours_in_the_plane() {
        // The first 64 × 64 cells of the finest size are a curve of their own.
        let mut cells: Vec<(u32, i32, i32)> =
            (0..64 * 64).map(|k| (along_hilbert(k % 64, k / 64), (k % 64) as i32, (k / 64) as i32)).collect();
        cells.sort_unstable();
        for pair in cells.windows(2) {
            let [(a, xa, ya), (b, xb, yb)] = [pair[0], pair[1]];
            assert_eq!((b - a, (xb - xa).abs() + (yb - ya).abs()), (1, 1), "{pair:?}");
        }
    }

    /// How unevenly samples lie to both sides of the line w·n = 0, whose n turns: the mean square of how many too
    /// many lie to one side.
    fn unevenness(samples: &[PixelSample], radius: f64) -> f64 {
        let surplus = |angle: f64| {
            let n = DVec2::from_angle(angle);
            let side =
                |s: &PixelSample| (s.within_px - 0.5 - radius * DVec2::new(s.u.x, -s.u.y)).dot(n).signum();
            samples.iter().map(side).sum::<f64>()
        };
        (0..64).map(|k| surplus(0.05 * f64::from(k)).powi(2)).sum::<f64>() / 64.0
    }

    #[test]
    fn samples_are_even_for_the_level_they_are_made_for() {
        let aperture = lens::ApertureSampler::new(&lens::ApertureShape::Disc.into());
        let sample = |[x, y, a, b]: [f64; 4]| PixelSample {
            within_px: DVec2::new(x, y),
            u: aperture.sample(a, b) * 0.1,
        };
        let of = |radius: f64, seed: u64| {
            let sheared = Sheared::new(seed, 256, vec![Level::of(radius)]);
            let mut samples = sheared.samples(&(0..256), 0.1, sample).remove(0);
            samples.iter_mut().for_each(|sample| sample.u /= 0.1);
            samples
        };
        for radius in [0.5, -1.0, 4.0] {
            let mean = |wrong: f64| {
                (0..32).map(|seed| unevenness(&of(wrong * radius, seed), radius)).sum::<f64>() / 32.0
            };
            // 256 independent samples: 256.
            let (right, turned) = (mean(1.0), mean(-1.0));
            assert!(right < 24.0, "{radius}: {right}");
            assert!(turned > 1.5 * right, "{radius}: {right}, turned {turned}");
        }
    }

    #[test]
    fn samples_go_on_over_passes_and_pools() {
        let sample =
            |[x, y, a, b]: [f64; 4]| PixelSample { within_px: DVec2::new(x, y), u: DVec2::new(a, b) };
        let sheared = Sheared::new(3, 4, vec![Level::SHARP, Level::of(-2.0)]);
        let whole = sheared.samples(&(0..150), 1.0, sample);
        let pieces: Vec<_> =
            [0..40, 40..130, 130..150].map(|piece| sheared.samples(&piece, 1.0, sample)).into();
        for (level, samples) in whole.iter().enumerate() {
            let joined: Vec<_> = pieces.iter().flat_map(|piece| piece[level].clone()).collect();
            assert_eq!(&joined, samples);
            let mut distinct: Vec<_> =
                samples[..64].iter().map(|s| s.u.to_array().map(f64::to_bits)).collect();
            distinct.sort_unstable();
            distinct.dedup();
            assert_eq!(distinct.len(), 64, "a pool of 64 gives each point once");
        }
        assert_ne!(whole[0], whole[1]);
    }
}
