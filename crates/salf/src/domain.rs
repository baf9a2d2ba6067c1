//! Where the pinhole picture is sampled: pixels of the frame, and ever larger cells outside it.

use glam::{DVec2, IVec2, UVec2};

/// A square of the pinhole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Upper left corner, px; negative left of or above the frame.
    pub corner: IVec2,
    /// Side, px; a power of two.
    pub side: i32,
}

/// How densely the rays through a cell lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Density {
    /// 4 × 4 rays, which represent four sub-cells each.
    Coarse,
    /// 8 × 8 rays: one in each sub-cell.
    Fine,
}

impl Density {
    /// The number of rays along each side of a cell.
    pub fn rays_per_side(self) -> usize {
        match self {
            Self::Coarse => Cell::SUBDIVISION / 2,
            Self::Fine => Cell::SUBDIVISION,
        }
    }

    /// The number of rays of a cell; rays are in the order of its sub-cells.
    pub fn rays(self) -> usize {
        self.rays_per_side() * self.rays_per_side()
    }

    /// The sub-cells that ray `ray` represents, a bit each.
    pub fn sub_cells(self, ray: usize) -> u64 {
        let each = Cell::SUB_CELLS / self.rays();
        (u64::MAX >> (Cell::SUB_CELLS - each)) << (ray * each)
    }
}

impl Cell {
    /// Sub-cells a side.
    const SUBDIVISION: usize = 8;
    /// Sub-cells of a cell; they are numbered along Morton's curve: quadrant by quadrant, and so on within each.
    pub const SUB_CELLS: usize = Self::SUBDIVISION * Self::SUBDIVISION;

    /// Row and column of place `k` along Morton's curve.
    pub fn row_and_column(k: usize) -> [usize; 2] {
        let every_second = |k: usize| k & 1 | (k >> 1) & 2 | (k >> 2) & 4;
        [every_second(k >> 1), every_second(k)]
    }

    /// The number of the first quadrant, 0 to 3, in which some of `sub_cells` (a bit each) lie.
    pub fn quadrant(sub_cells: u64) -> u32 {
        sub_cells.trailing_zeros() / 16
    }

    /// The quadrant that all of some sub-cells, a bit each, lie in; `None` if they lie in several.
    pub fn only_quadrant(sub_cells: u64) -> Option<u32> {
        let quadrant = Self::quadrant(sub_cells);
        (sub_cells >> (16 * quadrant) <= u64::from(u16::MAX)).then_some(quadrant)
    }

    /// The part of it that some sub-cells, a bit each, make up; they must not be none.
    pub fn part(&self, sub_cells: u64) -> CellPart {
        let (corner, cell_side) = (self.corner.as_dvec2(), self.side as f64);
        if sub_cells == u64::MAX {
            let half_size = DVec2::splat(cell_side / 2.0);
            return CellPart { center: corner + half_size, half_size, weight: cell_side * cell_side };
        }
        let (side, count) = (cell_side / Self::SUBDIVISION as f64, f64::from(sub_cells.count_ones()));
        let [sum, squares] = moments(sub_cells).map(|moment| moment.as_dvec2());
        let mean = sum / count;
        let center = corner + (mean + 0.5) * side;
        let variance = (squares / count - mean * mean) * side * side;
        // A box of half side h has the variance h²/3.
        let room = (center - corner).min(corner + cell_side - center);
        let half_size = (3.0 * variance + side * side / 4.0).map(f64::sqrt).min(room);
        CellPart { center, half_size, weight: side * side * count }
    }
}

/// The sums of the columns and rows of sub-cells, a bit each, and of their squares.
fn moments(sub_cells: u64) -> [UVec2; 2] {
    // Which sub-cells have the k-th binary digit of their column, or row.
    const COLUMN_DIGITS: [u64; 3] = [0xAAAA_AAAA_AAAA_AAAA, 0xF0F0_F0F0_F0F0_F0F0, 0xFFFF_0000_FFFF_0000];
    const ROW_DIGITS: [u64; 3] = [0xCCCC_CCCC_CCCC_CCCC, 0xFF00_FF00_FF00_FF00, 0xFFFF_FFFF_0000_0000];
    let of_axis = |digits: [u64; 3]| {
        let having = |mask: u64| (sub_cells & mask).count_ones();
        let [a, b, c] = digits;
        let [of_a, of_b, of_c] = digits.map(having);
        let squares =
            of_a + 4 * of_b + 16 * of_c + 4 * having(a & b) + 8 * having(a & c) + 16 * having(b & c);
        [of_a + 2 * of_b + 4 * of_c, squares]
    };
    let ([x, xx], [y, yy]) = (of_axis(COLUMN_DIGITS), of_axis(ROW_DIGITS));
    [UVec2::new(x, y), UVec2::new(xx, yy)]
}

/// Some or all sub-cells of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellPart {
    /// Their centre, px.
    pub center: DVec2,
    /// Half the sides of a box with their spread, within the cell, px.
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

    /// A picture of `width` × `height` px with a margin of at least `margin_px` on every side, a whole number of
    /// blocks.
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
        let IVec2 { x: columns, y: rows } = self.blocks();
        let of_row =
            |row: i32| (0..columns).flat_map(move |column| self.cells_of_block(IVec2::new(column, row)));
        (0..rows).map(|row| of_row(row).collect()).collect()
    }

    /// The number of blocks in a row, and of rows of them.
    pub fn blocks(&self) -> IVec2 {
        (self.extent() + Self::BLOCK - 1) / Self::BLOCK
    }

    /// The upper left corner, px, of a block, by its column and row.
    pub fn corner_of_block(&self, block: IVec2) -> IVec2 {
        block * Self::BLOCK - self.margin
    }

    /// The cells that a block is divided into.
    pub fn cells_of_block(&self, block: IVec2) -> Vec<Cell> {
        let mut cells = Vec::new();
        self.split(Cell { corner: self.corner_of_block(block), side: Self::BLOCK }, &mut cells);
        cells
    }

    /// Column and row of the block that `pixel` lies in, or of the nearest.
    pub fn nearest_block(&self, pixel: IVec2) -> IVec2 {
        let block = (pixel + self.margin).div_euclid(IVec2::splat(Self::BLOCK));
        block.clamp(IVec2::ZERO, self.blocks() - 1)
    }

    /// The cell that `pixel`, of the picture or its margin, lies in.
    pub fn cell_around(&self, pixel: IVec2) -> Cell {
        let block = (pixel + self.margin) / Self::BLOCK;
        let mut cell = Cell { corner: block * Self::BLOCK - self.margin, side: Self::BLOCK };
        while !self.is_fine(cell) {
            let side = cell.side / 2;
            let beyond_middle = pixel.cmpge(cell.corner + side);
            cell.corner += IVec2::select(beyond_middle, IVec2::splat(side), IVec2::ZERO);
            cell.side = side;
        }
        cell
    }

    fn is_fine(&self, cell: Cell) -> bool {
        cell.side == 1 || self.distance_outside(cell) >= 4 * cell.side
    }

    fn split(&self, cell: Cell, cells: &mut Vec<Cell>) {
        let beyond = self.size + self.margin;
        if cell.corner.x >= beyond.x || cell.corner.y >= beyond.y {
            return;
        }
        if self.is_fine(cell) {
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
    fn rays_stand_for_sub_cells_around_them() {
        for density in [Density::Coarse, Density::Fine] {
            let sub_cells = (0..density.rays()).map(|ray| density.sub_cells(ray));
            assert_eq!(sub_cells.clone().fold(0, |all, some| all ^ some), u64::MAX);
            let side = 8 / density.rays_per_side();
            for (ray, sub_cells) in sub_cells.enumerate() {
                let [row, column] = Cell::row_and_column(ray);
                for k in (0..Cell::SUB_CELLS).filter(|k| sub_cells >> k & 1 == 1) {
                    assert_eq!(Cell::row_and_column(k).map(|at| at / side), [row, column]);
                    assert_eq!(Cell::quadrant(sub_cells), (2 * (row * side / 4) + column * side / 4) as u32);
                }
            }
        }
    }

    #[test]
    fn a_part_of_a_cell_is_as_large_as_its_sub_cells() {
        let cell = Cell { corner: IVec2::new(-5, 3), side: 2 };
        for k in 0..500u64 {
            let some = 1 << (k % 64) | (k + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> (k % 63);
            let centers: Vec<_> = (0..Cell::SUB_CELLS)
                .filter(|k| some >> k & 1 == 1)
                .map(|k| Cell::row_and_column(k).map(|at| at as f64 + 0.5))
                .map(|[row, column]| DVec2::new(column, row) / 4.0 + cell.corner.as_dvec2())
                .collect();
            let (part, count) = (cell.part(some), centers.len() as f64);
            let center = centers.iter().sum::<DVec2>() / count;
            let variance =
                centers.iter().map(|at| (at - center).powf(2.0)).sum::<DVec2>() / count + 1.0 / 192.0;
            let room = (center - cell.corner.as_dvec2()).min(cell.corner.as_dvec2() + 2.0 - center);
            assert!((part.center - center).length() < 1e-12, "{part:?}");
            assert!(
                (part.half_size - (3.0 * variance).map(f64::sqrt).min(room)).length() < 1e-12,
                "{part:?}"
            );
            assert_eq!(part.weight, count / 16.0);
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
