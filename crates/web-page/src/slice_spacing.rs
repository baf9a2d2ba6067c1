//! Where the slices of a stack may be at most apart: whatever can be sharp is nearly so at some slice.

use crate::pixel_map::DistanceRange;

/// Where a stack needs slices before any error is measured.
#[derive(Clone, Copy, Debug)]
pub struct SliceSpacing<'a> {
    /// Reciprocal distances, ascending, at which something is sharp.
    pub sharp: &'a [f64],
    /// The focus distances of the stack.
    pub range: DistanceRange,
    /// The reciprocal distance in the range at which the page opens, which has a slice.
    pub opening: f64,
    /// How far the slice that shows a sharp distance best may be from it, > 0, 1/length.
    pub reach: f64,
}

impl SliceSpacing<'_> {
    /// The farthest that the slice after one at `last` may be on the way to `end`, both reciprocal distances: everything sharp between
    /// them is within reach of one of the two.
    pub(crate) fn next(&self, last: f64, end: f64) -> f64 {
        let uncovered = self.sharp.partition_point(|&sharp| sharp <= last + self.reach);
        self.sharp.get(uncovered).map_or(end, |sharp| end.min(sharp + self.reach))
    }

    /// The ends of the parts that are filled with slices after the farthest one, ascending.
    pub(crate) fn ends(&self) -> [f64; 2] {
        [self.opening, self.range.nearest]
    }

    /// How many slices a stack has at least; `None` if they are more than `most`.
    pub fn least_slices(&self, most: usize) -> Option<usize> {
        let (mut last, mut count) = (self.range.farthest, 1);
        for end in self.ends() {
            while last < end && count <= most {
                last = self.next(last, end);
                count += 1;
            }
        }
        (count <= most).then_some(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_range_has_one_slice_and_a_pinhole_three() {
        let range = DistanceRange { farthest: 0.5, nearest: 0.5 };
        let unit = DistanceRange { farthest: 0.0, nearest: 1.0 };
        let flat = SliceSpacing { sharp: &[0.5; 7], range, opening: 0.5, reach: 0.1 };
        assert_eq!(flat.least_slices(100), Some(1));
        let pinhole = SliceSpacing { sharp: &[0.1, 0.7], range: unit, opening: 0.2, reach: f64::INFINITY };
        assert_eq!(pinhole.least_slices(100), Some(3));
        let nothing_sharp = SliceSpacing { sharp: &[], range: unit, opening: 1.0, reach: 0.1 };
        assert_eq!(nothing_sharp.least_slices(100), Some(2));
    }
}
