//! Sets of points on a square.

use std::ops::{BitAnd, BitOrAssign, Sub};

/// A set of up to 256 points, a bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PointSet([u64; Self::WORDS]);

impl PointSet {
    const WORDS: usize = 4;
    /// The largest number of points.
    pub const MAX: usize = 64 * Self::WORDS;

    /// The set's bits, 64 points per word, the first in the lowest bit.
    #[inline(always)]
    pub fn words(&self) -> &[u64; Self::WORDS] {
        &self.0
    }

    #[inline(always)]
    pub(super) fn words_mut(&mut self) -> &mut [u64; Self::WORDS] {
        &mut self.0
    }

    /// Whether the set is empty.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        // Together, not compared: that would send the words through memory.
        let [a, b, c, d] = self.0;
        a | b | c | d == 0
    }

    /// Whether the point with this number is in the set.
    pub fn contains(&self, place: usize) -> bool {
        self.0[place / 64] >> (place % 64) & 1 == 1
    }

    /// The numbers of the points in the set, in ascending order.
    pub fn iter(self) -> impl Iterator<Item = usize> {
        self.0.into_iter().enumerate().flat_map(|(word, mut left)| {
            std::iter::from_fn(move || {
                let place = (left != 0).then(|| 64 * word + left.trailing_zeros() as usize)?;
                left &= left - 1;
                Some(place)
            })
        })
    }
}

impl From<[u32; PointSet::MAX / 32]> for PointSet {
    /// From the bits of 32 points a word, the first in the lowest bit.
    fn from(halves: [u32; PointSet::MAX / 32]) -> Self {
        Self(std::array::from_fn(|word| u64::from(halves[2 * word]) | u64::from(halves[2 * word + 1]) << 32))
    }
}

impl FromIterator<usize> for PointSet {
    fn from_iter<I: IntoIterator<Item = usize>>(places: I) -> Self {
        let mut set = Self::default();
        places.into_iter().for_each(|place| set.0[place / 64] |= 1 << (place % 64));
        set
    }
}

impl BitAnd for PointSet {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        Self([a & e, b & f, c & g, d & h])
    }
}

impl BitOrAssign for PointSet {
    #[inline(always)]
    fn bitor_assign(&mut self, other: Self) {
        for k in 0..Self::WORDS {
            self.0[k] |= other.0[k];
        }
    }
}

impl Sub for PointSet {
    type Output = Self;

    /// Those that `other` lacks.
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        Self([a & !e, b & !f, c & !g, d & !h])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_hold_what_was_put_in() {
        let some = [0usize, 3, 63, 64, 130, 255];
        let set: PointSet = some.into_iter().collect();
        assert_eq!(set.iter().collect::<Vec<_>>(), some);
        assert!(some.into_iter().all(|place| set.contains(place)) && !set.contains(129));
        let low: PointSet = (0..64).collect();
        assert_eq!((set & low).iter().collect::<Vec<_>>(), [0, 3, 63]);
        assert_eq!((set - low).iter().collect::<Vec<_>>(), [64, 130, 255]);
        let mut both = set - low;
        both |= set & low;
        assert_eq!(both, set);
        assert!((low - low).is_empty() && !low.is_empty());
    }
}
