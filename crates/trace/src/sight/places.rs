//! Places on a square.

use crate::sight::Shadow;
use glam::{DVec2, Vec4};

/// Places on a square, up to 64.
#[derive(Clone, Debug, Default)]
pub struct Places {
    /// By fours; what the last four do not use is at the square's middle.
    coordinates: Vec<[Vec4; 2]>,
    count: usize,
    /// By axis and strip of the square: the places in this strip and in those after it, in this and in those before.
    strips: [[[u64; 2]; STRIPS]; 2],
}

/// Strips that the square is cut into along either axis.
const STRIPS: usize = 8;

/// The strip of a coordinate; the first or the last for those outside. Never falls as the coordinate rises.
#[inline(always)]
fn strip(x: f32) -> usize {
    ((x + 1.0) * (STRIPS as f32 / 2.0)).clamp(0.0, STRIPS as f32 - 1.0) as usize
}

/// A box on the square.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub low: [f32; 2],
    pub high: [f32; 2],
}

impl Bounds {
    /// Whether it has nothing of the square.
    #[inline(always)]
    pub fn is_outside(&self) -> bool {
        (self.low[0] > 1.0) | (self.high[0] < -1.0) | (self.low[1] > 1.0) | (self.high[1] < -1.0)
    }
}

impl Places {
    /// As many as fit into a word.
    pub const MOST: usize = 64;

    /// From their coordinates in [−1, 1].
    ///
    /// # Panics
    /// If there are more than [`Self::MOST`].
    pub fn new(places: &[DVec2]) -> Self {
        assert!(places.len() <= Self::MOST, "at most {} places", Self::MOST);
        let four = |four: &[DVec2]| {
            let of = |axis: usize| {
                Vec4::from_array(std::array::from_fn(|k| four.get(k).map_or(0.0, |p| p[axis] as f32)))
            };
            [of(0), of(1)]
        };
        let mut strips = [[[0; 2]; STRIPS]; 2];
        for (k, place) in places.iter().enumerate() {
            for (axis, strips) in strips.iter_mut().enumerate() {
                let mine = strip(place[axis] as f32);
                strips[..=mine].iter_mut().for_each(|[after, _]| *after |= 1 << k);
                strips[mine..].iter_mut().for_each(|[_, before]| *before |= 1 << k);
            }
        }
        Self { coordinates: places.chunks(4).map(four).collect(), count: places.len(), strips }
    }

    /// A bit for each of them.
    pub fn all(&self) -> u64 {
        if self.count == 0 { 0 } else { u64::MAX >> (Self::MOST - self.count) }
    }

    /// How many there are.
    #[allow(clippy::len_without_is_empty, reason = "nobody asks for no places")]
    pub fn len(&self) -> usize {
        self.count
    }

    /// The coordinates of the place at `index`, as they are used: in f32.
    pub fn at(&self, index: usize) -> DVec2 {
        let [u, v] = self.coordinates[index / 4];
        DVec2::new(f64::from(u[index % 4]), f64::from(v[index % 4]))
    }

    /// Those in a box, and some that are not.
    #[inline(always)]
    pub(super) fn near(&self, bounds: &Bounds) -> u64 {
        let along = |axis: usize| {
            let strips = &self.strips[axis];
            strips[strip(bounds.low[axis])][0] & strips[strip(bounds.high[axis])][1]
        };
        along(0) & along(1)
    }

    /// Those of `bits` that lie in a shadow.
    #[inline(always)]
    pub(super) fn behind(&self, shadow: &Shadow, bits: u64) -> u64 {
        let [a, b, c] = shadow.edges;
        let (mut found, mut left) = (0, bits);
        while left != 0 {
            let chunk = left.trailing_zeros() / 4;
            let at = self.coordinates[chunk as usize];
            let within = a.of(at).min(b.of(at)).min(c.of(at)).cmpge(Vec4::ZERO);
            let behind = within & shadow.beyond.of(at).cmpgt(Vec4::ZERO);
            found |= u64::from(behind.bitmask()) << (4 * chunk);
            left &= !(0b1111 << (4 * chunk));
        }
        found & bits
    }

    /// The place of each bit.
    pub(crate) fn of_bits(&self, mut bits: u64) -> impl Iterator<Item = (usize, DVec2)> + '_ {
        std::iter::from_fn(move || {
            let index = (bits != 0).then(|| bits.trailing_zeros() as usize)?;
            bits &= bits - 1;
            Some((index, self.at(index)))
        })
    }
}
