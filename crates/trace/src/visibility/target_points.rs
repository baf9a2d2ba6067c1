//! Points on a square.

use crate::visibility::PointSet;
use crate::visibility::shadow::Shadow;
use glam::DVec2;

/// Points on a square, up to [`PointSet::MAX`].
#[derive(Clone, Debug, Default)]
pub struct TargetPoints {
    /// By groups; what the last group does not use is at the square's middle.
    coordinates: Vec<[[f32; GROUP]; 2]>,
    all: PointSet,
    /// By axis and strip of the square: the places in this strip and in those after it, in this and in those before.
    strips: [[[PointSet; 2]; STRIPS]; 2],
}

/// Points that are tested at once.
const GROUP: usize = 16;

/// Groups to a word of a [`PointSet`].
const GROUPS_PER_WORD: usize = u64::BITS as usize / GROUP;

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
        let group = |group: &[DVec2]| {
            [0, 1].map(|axis| std::array::from_fn(|k| group.get(k).map_or(0.0, |p| p[axis] as f32)))
        };
        let of_strips = |axis: usize| {
            let strip_of = |k: usize| strip(places[k][axis] as f32);
            let those =
                |is_one: &dyn Fn(usize) -> bool| (0..places.len()).filter(|&k| is_one(strip_of(k))).collect();
            std::array::from_fn(|strip| [those(&|mine| mine >= strip), those(&|mine| mine <= strip)])
        };
        Self {
            coordinates: places.chunks(GROUP).map(group).collect(),
            all: (0..places.len()).collect(),
            strips: [of_strips(0), of_strips(1)],
        }
    }

    /// The set of all points.
    pub fn all(&self) -> PointSet {
        self.all
    }

    /// The number of points.
    pub fn count(&self) -> usize {
        self.all.iter().count()
    }

    /// The coordinates, in [−1, 1]², of the point with number `index`, as they are used: rounded to f32.
    pub fn position(&self, index: usize) -> DVec2 {
        let [u, v] = &self.coordinates[index / GROUP];
        DVec2::new(f64::from(u[index % GROUP]), f64::from(v[index % GROUP]))
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
        let mut shadowed = PointSet::default();
        for (number, group) in self.coordinates.iter().enumerate() {
            let (word, first) = (number / GROUPS_PER_WORD, number % GROUPS_PER_WORD * GROUP);
            if candidates.words()[word] >> first & ((1 << GROUP) - 1) != 0 {
                shadowed.words_mut()[word] |= u64::from(shadow.covers(group)) << first;
            }
        }
        shadowed & candidates
    }
}
