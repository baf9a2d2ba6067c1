//! Filling of unknown disparities: with the farther of the surroundings.

use crate::mesh::cells::Grid;

/// Fills all NaNs, if there is a number at all: inward from known disparities, with the least of the neighbours.
pub fn fill_unknown_disparity([width, height]: [usize; 2], mut disparity: Vec<f32>) -> Vec<f32> {
    let grid = Grid { width, height };
    let mut border: Vec<usize> = (0..grid.count())
        .filter(|&cell| {
            disparity[cell].is_nan() && grid.around(cell).any(|(_, other)| !disparity[other].is_nan())
        })
        .collect();
    while !border.is_empty() {
        let least =
            |cell: usize| grid.around(cell).map(|(_, other)| disparity[other]).fold(f32::NAN, f32::min);
        let values: Vec<f32> = border.iter().map(|&cell| least(cell)).collect();
        for (&cell, value) in border.iter().zip(values) {
            disparity[cell] = value;
        }
        let mut next: Vec<usize> =
            border.iter().flat_map(|&cell| grid.around(cell).map(|(_, other)| other)).collect();
        next.retain(|&cell| disparity[cell].is_nan());
        next.sort_unstable();
        next.dedup();
        border = next;
    }
    disparity
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_disparities_are_as_far_as_the_farther_side() {
        let sparse = [1.0, f32::NAN, f32::NAN, f32::NAN, 0.2];
        let filled = fill_unknown_disparity([5, 1], sparse.to_vec());
        assert_eq!(filled, [1.0, 1.0, 0.2, 0.2, 0.2]);
        assert!(super::fill_unknown_disparity([2, 1], vec![f32::NAN; 2]).iter().all(|d| d.is_nan()));
    }
}
