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
//! spreads w evenly for all r at once. For a given r it is easy: a pool of points is halved by w's first
//! coordinate, the halves by its second, and so on, which gives every point an address in a square; samples are the
//! points that two-dimensional Sobol' points address. Errors at edges then fall with N^(−3/4), as in focus,
//! whatever the circle, and are as small. There are a few hundred such orders of the pool, for radii so close that
//! what lies between costs little ([`Level`]); [`super::survey`] chooses each pixel's.
//!
//! Where paint sends light from x to l = x + m·U/R, what decides what a pixel shows is the same with l for x and the
//! painted radius r + m for r. So samples are spread for the place l where light lands and x follows, modulo a pixel
//! ([`Spread`]): a pixel that light reaches then has the samples of just such a sequence, if all that send it light have
//! them.
//!
//! Every sample is evenly distributed over pixel and aperture whatever the order, so no choice makes a bias, if
//! only it is made without regard to the samples' own values.

use super::options::Sampler;
use super::samples::{self, LONGEST_SEQUENCE, PixelSample};
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

    /// The level nearest to a signed radius of the circle of confusion, px.
    pub fn from_radius(radius_px: f64) -> Self {
        let largest = f64::from(Self::LARGEST);
        Self((radius_px.asinh() / Self::STEP).round().clamp(-largest, largest) as i16)
    }

    /// The level's signed radius of the circle of confusion, px.
    pub fn radius_px(self) -> f64 {
        (f64::from(self.0) * Self::STEP).sinh()
    }

    /// Whether two levels are near enough to be those of one surface.
    pub fn is_near(self, other: Self) -> bool {
        (self.0 - other.0).abs() <= 2
    }

    /// The level's number among all, below [`Self::COUNT`].
    pub fn index(self) -> usize {
        (self.0 + Self::LARGEST) as usize
    }
}

/// What samples are spread for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spread {
    /// The circle of confusion, as painted.
    pub level: Level,
    /// The signed radius that paint adds to that of the standard lens, px: how far light moves that passes the
    /// aperture's edge. 0 without paint.
    pub moved_px: f64,
}

impl Spread {
    /// Where on its pixel a sample leaves that is to land where `sample` lies.
    fn leaving(self, sample: PixelSample, aperture_radius: f64) -> PixelSample {
        let moved = self.moved_px * in_aperture(&sample, aperture_radius);
        let left = sample.within_px - moved;
        // Rounding may make a fraction of a tiny negative number 1.
        let within_px = (left - left.floor()).min(DVec2::splat(1.0 - f64::EPSILON));
        if self.moved_px == 0.0 { sample } else { PixelSample { within_px, ..sample } }
    }
}

/// A sample's aperture point in units of the aperture's radius, in the picture's axes: its y is down, the aperture's
/// is up.
fn in_aperture(sample: &PixelSample, aperture_radius: f64) -> DVec2 {
    let u = if aperture_radius > 0.0 { sample.u / aperture_radius } else { DVec2::ZERO };
    DVec2::new(u.x, -u.y)
}

/// The points of the pool for each sample that is wanted: its own error must be small beside that of a choice of
/// so many.
const POOL: u64 = 16;

/// Sequences of samples, one for each of a few spreads.
pub(super) struct Sheared {
    seed: u64,
    /// Points of a pool, a power of two. After so many samples another pool goes on.
    size: u64,
    spreads: Vec<Spread>,
    latest: Mutex<Option<Arc<Pool>>>,
}

/// Points, and their orders by spread.
struct Pool {
    number: u64,
    points: Vec<PixelSample>,
    orders: Vec<Vec<u32>>,
}

impl Sheared {
    /// Sequences for `spreads`, of which about `samples_per_pixel` samples are wanted.
    pub fn new(seed: u64, samples_per_pixel: u32, spreads: Vec<Spread>) -> Self {
        let size = (POOL * u64::from(samples_per_pixel)).next_power_of_two().min(LONGEST_SEQUENCE);
        Self { seed, size, spreads, latest: Mutex::new(None) }
    }

    /// For every spread, the samples `passed` of its pixel; `sample` makes one of four uniform numbers in [0, 1).
    pub fn samples(
        &self,
        passed: &Range<u32>,
        aperture_radius: f64,
        sample: impl Fn([f64; 4]) -> PixelSample,
    ) -> Vec<Vec<PixelSample>> {
        let mut samples = vec![Vec::with_capacity(passed.len()); self.spreads.len()];
        let (mut from, end) = (u64::from(passed.start), u64::from(passed.end));
        while from < end {
            let number = from / self.size;
            let pool = self.pool(number, aperture_radius, &sample);
            let until = end.min((number + 1) * self.size);
            let scramble = hash([self.seed, ADDRESSES, number]) as u32;
            for index in from..until {
                let square =
                    [0, 1].map(|axis| sobol_burley::sample((index % self.size) as u32, axis, scramble));
                let address = address(square.map(f64::from), self.size);
                for ((samples, order), spread) in samples.iter_mut().zip(&pool.orders).zip(&self.spreads) {
                    let point = pool.points[order[address] as usize];
                    samples.push(spread.leaving(point, aperture_radius));
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
        let orders =
            self.spreads.par_iter().map(|spread| order(&points, spread.level, aperture_radius)).collect();
        latest.insert(Arc::new(Pool { number, points, orders })).clone()
    }
}

/// Tell the seeds of the pools' points and of the addresses that samples take from others.
const POINTS: u64 = 1;
const ADDRESSES: u64 = 2;

/// The indices of `pool` by their address over w, first coordinate first; `aperture_radius` in scene units.
pub(super) fn order(pool: &[PixelSample], level: Level, aperture_radius: f64) -> Vec<u32> {
    let radius = level.radius_px();
    let crossing =
        |sample: &PixelSample| (sample.within_px - radius * in_aperture(sample, aperture_radius)).to_array();
    let crossings: Vec<[f64; 2]> = pool.iter().map(crossing).collect();
    let mut order: Vec<u32> = (0..pool.len() as u32).collect();
    halve(&mut order, &crossings, 0);
    order
}

/// Puts those with the smaller coordinate along `axis` into the first half, and halves the halves along the other.
fn halve(order: &mut [u32], crossings: &[[f64; 2]], axis: usize) {
    if order.len() < 2 {
        return;
    }
    let coordinate = |k: &u32| crossings[*k as usize][axis];
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, |a, b| coordinate(a).total_cmp(&coordinate(b)).then(a.cmp(b)));
    let (low, high) = order.split_at_mut(middle);
    halve(low, crossings, 1 - axis);
    halve(high, crossings, 1 - axis);
}

/// The address of a point of the unit square among `size`, a power of two up to 2¹⁶: bits of its coordinates in turn.
fn address([x, y]: [f64; 2], size: u64) -> usize {
    let fixed = [x, y].map(|c| (c * f64::from(1u32 << 16)) as usize);
    (0..size.trailing_zeros())
        .fold(0, |address, k| address << 1 | (fixed[k as usize % 2] >> (15 - k / 2)) & 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_lie_close_and_reach_far() {
        for radius in [0.0, 0.01, -0.5, 1.0, -3.0, 40.0, -1e3, 1e4] {
            let level = Level::from_radius(radius);
            assert!((level.radius_px() - radius).abs() <= 0.0201 * radius.hypot(1.0), "{radius}");
            assert!(level.index() < Level::COUNT);
            assert_eq!(Level::from_radius(level.radius_px()), level);
        }
        assert_eq!(Level::from_radius(0.0), Level::SHARP);
        assert_eq!(Level::from_radius(f64::INFINITY).index(), Level::COUNT - 1);
        assert_eq!(Level::from_radius(f64::NEG_INFINITY).index(), 0);
    }

    #[test]
    fn an_address_is_where_a_point_lies() {
        // In focus w is the place on the pixel: a grid of 8 × 8 is addressed by itself.
        let at = |k: u32| DVec2::new(f64::from(k % 8) + 0.5, f64::from(k / 8) + 0.5) / 8.0;
        let pool: Vec<_> = (0..64).map(|k| PixelSample { within_px: at(k), u: DVec2::ONE }).collect();
        let order = order(&pool, Level::SHARP, 1.0);
        for k in 0..64 {
            assert_eq!(order[address(at(k).to_array(), 64)], k);
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
            let sheared =
                Sheared::new(seed, 256, vec![Spread { level: Level::from_radius(radius), moved_px: 0.0 }]);
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
    fn what_paint_moves_is_even_where_it_lands() {
        let aperture = lens::ApertureSampler::new(&lens::ApertureShape::Disc.into());
        let sample =
            |[x, y, a, b]: [f64; 4]| PixelSample { within_px: DVec2::new(x, y), u: aperture.sample(a, b) };
        let of = |moved_px: f64, seed: u64| {
            let spread = Spread { level: Level::from_radius(1.0), moved_px };
            Sheared::new(seed, 256, vec![spread]).samples(&(0..256), 1.0, sample).remove(0)
        };
        let landing = |samples: Vec<PixelSample>, by: f64| -> Vec<PixelSample> {
            let land = |s: PixelSample| PixelSample {
                within_px: (s.within_px + by * DVec2::new(s.u.x, -s.u.y)).rem_euclid(DVec2::ONE),
                ..s
            };
            samples.into_iter().map(land).collect()
        };
        for moved in [0.7, -5.0] {
            let left = of(moved, 1);
            assert!(
                left.iter()
                    .all(|s| s.within_px.cmpge(DVec2::ZERO).all() && s.within_px.cmplt(DVec2::ONE).all())
            );
            // Where they leave they are spread over the pixel as well.
            let mean = left.iter().map(|s| s.within_px).sum::<DVec2>() / 256.0;
            assert!((mean - 0.5).abs().max_element() < 0.06, "{mean}");
            let mean = |moved: f64, by: f64| {
                (0..32).map(|seed| unevenness(&landing(of(moved, seed), by), 1.0)).sum::<f64>() / 32.0
            };
            // Negative control: as if nothing had been moved.
            let (right, unmoved) = (mean(moved, moved), mean(0.0, moved));
            assert!(right < 24.0 && unmoved > 1.5 * right, "{moved}: {right}, unmoved {unmoved}");
        }
    }

    #[test]
    fn samples_go_on_over_passes_and_pools() {
        let sample =
            |[x, y, a, b]: [f64; 4]| PixelSample { within_px: DVec2::new(x, y), u: DVec2::new(a, b) };
        let sheared = Sheared::new(
            3,
            4,
            [0.0, -2.0].map(|r| Spread { level: Level::from_radius(r), moved_px: 0.0 }).into(),
        );
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
