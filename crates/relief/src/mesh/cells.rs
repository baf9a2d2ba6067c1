//! Pixels of layers, and which of them are connected.

/// The layers: what the picture shows, and the continuation behind it.
pub(crate) const LAYERS: usize = 2;

/// A grid of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grid {
    pub width: usize,
    pub height: usize,
}

impl Grid {
    /// The number of its cells.
    pub fn count(self) -> usize {
        self.width * self.height
    }

    /// The number of the cell in column `x` and row `y`.
    pub fn at(self, x: usize, y: usize) -> usize {
        y * self.width + x
    }

    /// The numbers of the cells left, right, above and below, as far as they exist.
    pub fn around(self, cell: usize) -> impl Iterator<Item = (Side, usize)> {
        let (x, y) = (cell % self.width, cell / self.width);
        let sides = [
            (x > 0).then(|| (Side::Left, cell - 1)),
            (x + 1 < self.width).then(|| (Side::Right, cell + 1)),
            (y > 0).then(|| (Side::Above, cell - self.width)),
            (y + 1 < self.height).then(|| (Side::Below, cell + self.width)),
        ];
        sides.into_iter().flatten()
    }
}

/// A side of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Left,
    Right,
    Above,
    Below,
}

/// The index of a side where there is a value for each: left, right, above, below.
pub(crate) fn side_index(side: Side) -> usize {
    match side {
        Side::Left => 0,
        Side::Right => 1,
        Side::Above => 2,
        Side::Below => 3,
    }
}

/// Connectivity: whether a cell is connected to the one right of it, and to the one below.
#[derive(Clone, Debug)]
pub(crate) struct Links {
    grid: Grid,
    right: Vec<bool>,
    below: Vec<bool>,
}

impl Links {
    /// Links by which no cell is connected to another.
    pub fn none(grid: Grid) -> Self {
        Self { grid, right: vec![false; grid.count()], below: vec![false; grid.count()] }
    }

    /// Whether a cell is connected to the one on that side, which must exist.
    pub fn has(&self, cell: usize, side: Side) -> bool {
        match side {
            Side::Left => self.right[cell - 1],
            Side::Right => self.right[cell],
            Side::Above => self.below[cell - self.grid.width],
            Side::Below => self.below[cell],
        }
    }

    /// Links a cell to its neighbour on a side, or cuts it off. The neighbour must exist.
    pub fn set(&mut self, cell: usize, side: Side, is_linked: bool) {
        match side {
            Side::Left => self.right[cell - 1] = is_linked,
            Side::Right => self.right[cell] = is_linked,
            Side::Above => self.below[cell - self.grid.width] = is_linked,
            Side::Below => self.below[cell] = is_linked,
        }
    }
}

/// Cells of both layers: disparities (NaN: no cell), and connections within and between layers.
pub(crate) struct Cells {
    pub grid: Grid,
    /// By layer.
    pub disparity: [Vec<f32>; LAYERS],
    pub links: [Links; LAYERS],
    /// For each cell of the second layer, on which sides it continues a cell of the first.
    pub onward: Vec<[bool; 4]>,
}

impl Cells {
    /// Whether a layer has a surface in a cell.
    pub fn is_there(&self, layer: usize, cell: usize) -> bool {
        !self.disparity[layer][cell].is_nan()
    }

    /// The change of disparity from cell to cell, to the right and downward, averaged over the connected neighbours.
    pub fn slope(&self, layer: usize, cell: usize) -> [f32; 2] {
        let disparity = &self.disparity[layer];
        let (mut sums, mut counts) = ([0.0; 2], [0.0f32; 2]);
        for (side, other) in self.grid.around(cell) {
            if !self.links[layer].has(cell, side) {
                continue;
            }
            let step = disparity[other] - disparity[cell];
            let (axis, step) = match side {
                Side::Left => (0, -step),
                Side::Right => (0, step),
                Side::Above => (1, -step),
                Side::Below => (1, step),
            };
            sums[axis] += step;
            counts[axis] += 1.0;
        }
        [0, 1].map(|axis| sums[axis] / counts[axis].max(1.0))
    }
}
