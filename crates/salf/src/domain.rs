//! Where the pinhole picture is sampled: pixels of the frame, and ever larger cells outside it.

use glam::{DVec2, IVec2};

/// A square of the pinhole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Upper left corner, px; negative left of or above the frame.
    pub corner: IVec2,
    /// Side, px; a power of two.
    pub side: i32,
}

impl Cell {
    /// Sub-cells a side: a ray is traced in each.
    pub const SUBDIVISION: i32 = 4;
    /// Rays a cell.
    pub const RAYS: usize = (Self::SUBDIVISION * Self::SUBDIVISION) as usize;

    /// The sub-cells, quadrant by quadrant: every fourth of them lies in another one.
    pub fn sub_cells() -> impl Iterator<Item = usize> {
        let bit = |k: usize, index: usize| k >> index & 1;
        (0..Self::RAYS).map(move |k| {
            let (row, column) = (2 * bit(k, 3) + bit(k, 1), 2 * bit(k, 2) + bit(k, 0));
            row * Self::SUBDIVISION as usize + column
        })
    }

    /// The row and the column of sub-cell `k`.
    pub fn row_and_column(k: usize) -> [usize; 2] {
        [k / Self::SUBDIVISION as usize, k % Self::SUBDIVISION as usize]
    }

    /// The corner of sub-cell `k`, px.
    pub fn sub_corner(&self, k: usize) -> DVec2 {
        let [row, column] = Self::row_and_column(k);
        self.corner.as_dvec2() + DVec2::new(column as f64, row as f64) * self.sub_side()
    }

    /// The quadrant that sub-cell `k` lies in.
    pub fn quadrant(k: usize) -> usize {
        const HALF: usize = Cell::SUBDIVISION as usize / 2;
        let [row, column] = Self::row_and_column(k);
        row / HALF * 2 + column / HALF
    }

    /// The part of it that the sub-cells of `rays`, a bit each, make up; they must not be none.
    pub fn part(&self, rays: u16) -> CellPart {
        let (cell_side, side) = (self.side as f64, self.sub_side());
        if rays == u16::MAX {
            let half_size = DVec2::splat(cell_side / 2.0);
            let center = self.corner.as_dvec2() + half_size;
            return CellPart { center, half_size, weight: cell_side * cell_side };
        }
        let count = f64::from(rays.count_ones());
        let corners = || (0..Self::RAYS).filter(|k| rays >> k & 1 == 1).map(|k| self.sub_corner(k));
        let center = corners().sum::<DVec2>() / count + side / 2.0;
        let variance =
            corners().map(|corner| (corner + side / 2.0 - center).powf(2.0)).sum::<DVec2>() / count;
        // A box of half side h has the variance h²/3.
        let low = self.corner.as_dvec2();
        let room = (center - low).min(low + cell_side - center);
        let half_size = (3.0 * variance + side * side / 4.0).map(f64::sqrt).min(room);
        CellPart { center, half_size, weight: side * side * count }
    }

    /// The side of a sub-cell, px.
    pub fn sub_side(&self) -> f64 {
        self.side as f64 / Self::SUBDIVISION as f64
    }
}

/// Some or all rays of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellPart {
    /// The centre of their sub-cells, px.
    pub center: DVec2,
    /// Half the sides of a box with the spread of the sub-cells, within the cell, px.
    pub half_size: DVec2,
    /// Their area, px².
    pub weight: f64,
}

/// The frame and its margin.
#[derive(Clone, Copy, Debug)]
pub struct Domain {
    /// The frame, px.
    pub size: IVec2,
    /// Margin on every side, px; a multiple of [`Domain::BLOCK`].
    pub margin: i32,
}

impl Domain {
    /// The largest cell, px.
    pub const BLOCK: i32 = 16;

    /// A frame with a margin of at least `margin_px`.
    pub fn new(width: u32, height: u32, margin_px: f64) -> Self {
        let margin = (margin_px / Self::BLOCK as f64).ceil() as i32 * Self::BLOCK;
        Self { size: IVec2::new(width as i32, height as i32), margin }
    }

    /// Columns and rows with the margin, px.
    pub fn extent(&self) -> IVec2 {
        self.size + 2 * self.margin
    }

    /// The cells, in rows of blocks.
    ///
    /// A cell outside the frame has at most a quarter of its distance to the frame as its side: only light that
    /// is spread at least that far can enter the frame, so that its splat is eight cells wide or wider.
    pub fn block_rows(&self) -> Vec<Vec<Cell>> {
        let blocks = (self.extent() + Self::BLOCK - 1) / Self::BLOCK;
        (0..blocks.y)
            .map(|row| {
                let mut cells = Vec::new();
                for column in 0..blocks.x {
                    let corner = IVec2::new(column, row) * Self::BLOCK - self.margin;
                    self.split(Cell { corner, side: Self::BLOCK }, &mut cells);
                }
                cells
            })
            .collect()
    }

    /// The cell that `pixel`, of the frame or its margin, lies in.
    pub fn cell_around(&self, pixel: IVec2) -> Cell {
        let block = (pixel + self.margin) / Self::BLOCK;
        let mut cell = Cell { corner: block * Self::BLOCK - self.margin, side: Self::BLOCK };
        while !self.is_fine_enough(cell) {
            let side = cell.side / 2;
            let beyond_middle = pixel.cmpge(cell.corner + side);
            cell.corner += IVec2::select(beyond_middle, IVec2::splat(side), IVec2::ZERO);
            cell.side = side;
        }
        cell
    }

    fn is_fine_enough(&self, cell: Cell) -> bool {
        cell.side == 1 || self.distance_outside(cell) >= 4 * cell.side
    }

    fn split(&self, cell: Cell, cells: &mut Vec<Cell>) {
        let beyond = self.size + self.margin;
        if cell.corner.x >= beyond.x || cell.corner.y >= beyond.y {
            return;
        }
        if self.is_fine_enough(cell) {
            cells.push(cell);
            return;
        }
        let side = cell.side / 2;
        for step in [IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::ONE] {
            self.split(Cell { corner: cell.corner + step * side, side }, cells);
        }
    }

    /// How far the cell lies outside the frame, px; 0 inside.
    fn distance_outside(&self, cell: Cell) -> i32 {
        let before = -(cell.corner + cell.side);
        let behind = cell.corner - self.size;
        before.max(behind).max_element().max(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sub_cells_come_by_quadrants() {
        let cell = Cell { corner: IVec2::ZERO, side: 4 };
        let corners: Vec<_> = Cell::sub_cells().map(|k| cell.sub_corner(k)).collect();
        for (four, quadrant) in corners.chunks(4).zip([(0.0, 0.0), (2.0, 0.0), (0.0, 2.0), (2.0, 2.0)]) {
            let low = DVec2::from(quadrant);
            let wanted = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|step| low + step);
            assert_eq!(four, wanted);
        }
    }

    #[test]
    fn cells_tile_the_domain() {
        let domain = Domain::new(37, 21, 70.0);
        let extent = domain.extent();
        let mut covered = vec![0; (extent.x * extent.y) as usize];
        for cell in domain.block_rows().into_iter().flatten() {
            for y in 0..cell.side {
                for x in 0..cell.side {
                    let p = cell.corner + IVec2::new(x, y) + domain.margin;
                    if p.x < extent.x && p.y < extent.y {
                        covered[(p.y * extent.x + p.x) as usize] += 1;
                    }
                }
            }
            assert_eq!(domain.cell_around(cell.corner + cell.side / 2), cell);
            let inside = cell.corner.cmpge(IVec2::ZERO).all() && cell.corner.cmplt(domain.size).all();
            assert!(!inside || cell.side == 1);
        }
        assert!(covered.iter().all(|&n| n == 1));
    }
}
