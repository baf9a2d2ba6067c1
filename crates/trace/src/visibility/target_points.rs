//! Points on a square.

use crate::visibility::PointSet;
use crate::visibility::shadow::Shadow;
use glam::{DVec2, Vec4};

/// Points on a square, up to [`PointSet::MAX`].
#[derive(Clone, Debug, Default)]
pub struct TargetPoints {
    /// By fours; what the last four do not use is at the square's middle.
    coordinates: Vec<[Vec4; 2]>,
    all: PointSet,
    /// By axis and strip of the square: the places in this strip and in those after it, in this and in those before.
    strips: [[[PointSet; 2]; STRIPS]; 2],
}

/// Strips that the square is cut into along either axis: finer than places lie, so that what is small has few of them.
const STRIPS: usize = 32;

/// The strip of a coordinate; the first or the last for those outside. Never falls as the coordinate rises.
#[inline(always)]
fn strip(x: f32) -> usize {
    // From here on floats are whole numbers, and end in their digits.
    const WHOLE: f32 = (1u32 << 23) as f32;
    let at = ((x + 1.0) * (STRIPS as f32 / 2.0)).clamp(0.0, STRIPS as f32 - 1.0);
    (at + WHOLE).to_bits() as usize % STRIPS
}

/// A box on the square.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// The least coordinates on the square.
    pub low: [f32; 2],
    /// The greatest coordinates on the square.
    pub high: [f32; 2],
}

impl TargetPoints {
    /// The points with these coordinates on the square, in [−1, 1]².
    ///
    /// # Panics
    /// If there are more than [`PointSet::MAX`].
    pub fn new(places: &[DVec2]) -> Self {
        assert!(places.len() <= PointSet::MAX, "at most {} points", PointSet::MAX);
        let four = |four: &[DVec2]| {
            let of = |axis: usize| {
                Vec4::from_array(std::array::from_fn(|k| four.get(k).map_or(0.0, |p| p[axis] as f32)))
            };
            [of(0), of(1)]
        };
        let of_strips = |axis: usize| {
            let strip_of = |k: usize| strip(places[k][axis] as f32);
            let those =
                |is_one: &dyn Fn(usize) -> bool| (0..places.len()).filter(|&k| is_one(strip_of(k))).collect();
            std::array::from_fn(|strip| [those(&|mine| mine >= strip), those(&|mine| mine <= strip)])
        };
        Self {
            coordinates: places.chunks(4).map(four).collect(),
            all: (0..places.len()).collect(),
            strips: [of_strips(0), of_strips(1)],
        }
    }

    /// The set of all points.
    pub fn all(&self) -> PointSet {
        self.all
    }

    /// The coordinates, in [−1, 1]², of the point with number `index`, as they are used: rounded to f32.
    pub fn position(&self, index: usize) -> DVec2 {
        let [u, v] = self.coordinates[index / 4];
        DVec2::new(f64::from(u[index % 4]), f64::from(v[index % 4]))
    }

    /// Those in a box, and some that are not.
    #[inline(always)]
    pub(super) fn near_box(&self, bounds: &Bounds) -> PointSet {
        let along = |axis: usize| {
            let strips = &self.strips[axis];
            strips[strip(bounds.low[axis])][0] & strips[strip(bounds.high[axis])][1]
        };
        along(0) & along(1)
    }

    /// Those of some that lie in a shadow.
    #[inline(always)]
    pub(super) fn in_shadow(&self, shadow: &Shadow, candidates: PointSet) -> PointSet {
        let [a, b, c] = shadow.edges;
        let mut shadowed = PointSet::default();
        for (word, chunks) in self.coordinates.chunks(16).enumerate() {
            let mut left = candidates.words()[word];
            while left != 0 {
                let chunk = left.trailing_zeros() / 4;
                let at = chunks[chunk as usize];
                let within = a.evaluate(at).min(b.evaluate(at)).min(c.evaluate(at)).cmpge(Vec4::ZERO);
                let behind = within & shadow.beyond.evaluate(at).cmpgt(Vec4::ZERO);
                shadowed.words_mut()[word] |= u64::from(behind.bitmask()) << (4 * chunk);
                left &= !(0b1111 << (4 * chunk));
            }
        }
        shadowed & candidates
    }
}
