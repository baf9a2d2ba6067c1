//! Corners of cells, shared by the connected cells around them.
//!
//! Around a corner of the grid lie up to four cells per layer. Those that are connected, within a layer or between layers, share one
//! point there; its disparity is the mean of their extrapolations, each by its own slope.

use crate::mesh::cells::{Cells, LAYERS, Side, side_index};

/// The cells around a corner of the grid: upper left, upper right, lower left, lower right; first those of the first layer.
const AROUND: usize = 4 * LAYERS;

/// A corner as one of its cells has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    /// Column and row in the grid of corners.
    pub at: [usize; 2],
    /// Which of the points there: the smallest number of the cells that share it.
    pub point: u8,
    pub disparity: f32,
}

/// The state of a corner of the grid for a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Joint {
    /// All four cells exist and are connected to each other, none to the other layer; the disparity.
    Whole(f32),
    /// Some cells are missing or not connected.
    Cut,
    /// There are no cells.
    Absent,
}

impl Cells {
    /// The corner of a cell: `right` and `below` select which.
    pub(crate) fn corner(&self, layer: usize, cell: usize, [right, below]: [bool; 2]) -> Corner {
        let (x, y) = (cell % self.grid.width, cell / self.grid.width);
        let at = [x + usize::from(right), y + usize::from(below)];
        let around = self.around(at);
        // As seen from the corner, the cell lies on the other side.
        let quadrant = usize::from(!right) + 2 * usize::from(!below);
        let shared = self.shared(&around);
        let point = shared[4 * layer + quadrant];
        Corner { at, point, disparity: self.disparity_at(&around, &shared, point) }
    }

    /// A corner of the grid as one of the cells there has it, if that exists: the cell left of it and above it where `is_after` is true, else
    /// right and below.
    pub(crate) fn corner_at(&self, layer: usize, at: [usize; 2], is_after: [bool; 2]) -> Option<Corner> {
        let [x, y] = [0, 1].map(|axis| at[axis].wrapping_sub(usize::from(is_after[axis])));
        let is_there =
            x < self.grid.width && y < self.grid.height && self.is_there(layer, self.grid.at(x, y));
        is_there.then(|| self.corner(layer, self.grid.at(x, y), is_after))
    }

    /// The state of a corner of the grid for a layer.
    pub(crate) fn joint(&self, layer: usize, at: [usize; 2]) -> Joint {
        let around = self.around(at);
        let own = 4 * layer..4 * layer + 4;
        match around[own.clone()].iter().flatten().count() {
            0 => return Joint::Absent,
            4 => {}
            _ => return Joint::Cut,
        }
        let has = |place: usize, side| {
            around[own.start + place].is_some_and(|cell| self.links[layer].has(cell, side))
        };
        let is_ring = has(0, Side::Right) && has(0, Side::Below) && has(3, Side::Left) && has(3, Side::Above);
        let shared = self.shared(&around);
        let point = shared[own.start];
        let is_own =
            shared.iter().enumerate().all(|(place, &other)| own.contains(&place) == (other == point));
        match is_ring && is_own {
            true => Joint::Whole(self.disparity_at(&around, &shared, point)),
            false => Joint::Cut,
        }
    }

    fn around(&self, [i, j]: [usize; 2]) -> [Option<usize>; AROUND] {
        let mut around = [None; AROUND];
        for (place, slot) in around.iter_mut().enumerate() {
            let (right, below) = (place % 2, place / 2 % 2);
            let (Some(x), Some(y)) = ((i + right).checked_sub(1), (j + below).checked_sub(1)) else {
                continue;
            };
            if x < self.grid.width && y < self.grid.height {
                *slot = Some(self.grid.at(x, y)).filter(|&cell| self.is_there(place / 4, cell));
            }
        }
        around
    }

    /// For each cell around a corner, the smallest number of the cells that it shares the corner with.
    fn shared(&self, around: &[Option<usize>; AROUND]) -> [u8; AROUND] {
        let mut shared: [u8; AROUND] = std::array::from_fn(|place| place as u8);
        let mut join = |a: usize, b: usize| {
            let (low, high) = (shared[a].min(shared[b]), shared[a].max(shared[b]));
            shared.iter_mut().filter(|point| **point == high).for_each(|point| *point = low);
        };
        for (place, &cell) in around.iter().enumerate() {
            let Some(cell) = cell else { continue };
            let layer = place / 4;
            let sides = [
                if place % 2 == 0 { (Side::Right, place + 1) } else { (Side::Left, place - 1) },
                if place / 2 % 2 == 0 { (Side::Below, place + 2) } else { (Side::Above, place - 2) },
            ];
            for (side, beside) in sides {
                if around[beside].is_some() && self.links[layer].has(cell, side) {
                    join(place, beside);
                }
                if layer == 1 && around[beside - 4].is_some() && self.onward[cell][side_index(side)] {
                    join(place, beside - 4);
                }
            }
        }
        shared
    }

    fn disparity_at(&self, around: &[Option<usize>; AROUND], shared: &[u8; AROUND], point: u8) -> f32 {
        let (mut sum, mut count) = (0.0, 0.0f32);
        for (place, &cell) in around.iter().enumerate() {
            let Some(cell) = cell.filter(|_| shared[place] == point) else { continue };
            let layer = place / 4;
            let [across, down] = self.slope(layer, cell);
            // The corner lies right of the cells on the left.
            let right = if place % 2 == 0 { 0.5 } else { -0.5 };
            let below = if place / 2 % 2 == 0 { 0.5 } else { -0.5 };
            sum += self.disparity[layer][cell] + across * right + down * below;
            count += 1.0;
        }
        sum / count.max(1.0)
    }
}
