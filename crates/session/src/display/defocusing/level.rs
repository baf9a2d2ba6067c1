//! What covers a pixel, by the size of its circle of confusion: large circles in cells of several pixels.

use super::cells::{MAX_RADIUS_CELLS, MIN_RADIUS_PX, Value, add_share, cells_within, level_of};
use super::covers::Covers;

/// Sides of the tiles whose largest radius is known, in cells; at least the largest radius.
const TILE_CELLS: usize = 8;

/// The hits whose circles are of about the same size.
pub(super) struct Level {
    /// Pixels a side of a cell.
    side: usize,
    /// Columns and rows of cells.
    size: [usize; 2],
    cells: Vec<Cell>,
    /// Columns of tiles.
    tile_columns: usize,
    /// The largest radius in each, px; 0 where there is no hit.
    tiles: Vec<f32>,
}

/// Hits of a level in a cell.
#[derive(Clone, Copy)]
struct Cell {
    /// Of how much each pixel of their circles is covered, and the light that is there.
    cover: [f32; 5],
    /// The largest radius, px.
    radius: f32,
    /// The nearest slice.
    slice: u8,
}

impl Level {
    pub fn new(
        level: usize,
        [width, height]: [usize; 2],
        radii: &[f32],
        values: &[Value],
        slices: &[u8],
    ) -> Self {
        let side = 1 << level;
        let size = [width.div_ceil(side), height.div_ceil(side)];
        let tile_columns = size[0].div_ceil(TILE_CELLS);
        let none = Cell { cover: [0.0; 5], radius: 0.0, slice: u8::MAX };
        let mut cells = vec![none; size[0] * size[1]];
        let mut tiles = vec![0.0f32; tile_columns * size[1].div_ceil(TILE_CELLS)];
        let largest = MAX_RADIUS_CELLS * side as f32;
        for (index, &radius) in radii.iter().enumerate() {
            if level_of(radius) != level {
                continue;
            }
            let radius = radius.clamp(MIN_RADIUS_PX, largest);
            let [column, row] = [index % width / side, index / width / side];
            let cell = &mut cells[row * size[0] + column];
            let area = std::f32::consts::PI * (radius * radius + (side * side) as f32 / 12.0);
            let [r, g, b, coverage] = values[index];
            add_share(&mut cell.cover, &[r, g, b, coverage, 1.0], 1.0 / area);
            cell.radius = cell.radius.max(radius);
            cell.slice = cell.slice.min(slices[index]);
            let tile = &mut tiles[row / TILE_CELLS * tile_columns + column / TILE_CELLS];
            *tile = tile.max(radius);
        }
        Self { side, size, cells, tile_columns, tiles }
    }

    /// Adds what covers a place of the picture, px.
    pub fn add_what_covers(&self, place: [f32; 2], covers: &mut Covers) {
        let per_cell = 1.0 / self.side as f32;
        let [x, y] = [place[0] * per_cell, place[1] * per_cell];
        let largest = self.largest_radius_near(x as usize, y as usize);
        if largest == 0.0 {
            return;
        }
        let reach = largest * per_cell + 0.5;
        let [columns, rows] = [cells_within(x, reach, self.size[0]), cells_within(y, reach, self.size[1])];
        for row in rows {
            for column in columns.clone() {
                let cell = &self.cells[row * self.size[0] + column];
                let (dx, dy) = (column as f32 + 0.5 - x, row as f32 + 0.5 - y);
                // The rim of a circle is as soft as a cell is wide.
                let share = (cell.radius * per_cell - (dx * dx + dy * dy).sqrt() + 0.5).min(1.0);
                if share > 0.0 && cell.cover[4] > 0.0 {
                    add_share(&mut covers.slices[usize::from(cell.slice)], &cell.cover, share);
                    covers.occupied |= 1 << cell.slice;
                    covers.min_radius = covers.min_radius.min(cell.radius);
                }
            }
        }
    }

    /// The largest radius (px) in the tiles around a cell.
    fn largest_radius_near(&self, column: usize, row: usize) -> f32 {
        let tile_rows = self.tiles.len() / self.tile_columns;
        let [column, row] = [column / TILE_CELLS, row / TILE_CELLS];
        let mut largest = 0.0f32;
        for row in row.saturating_sub(1)..(row + 2).min(tile_rows) {
            for column in column.saturating_sub(1)..(column + 2).min(self.tile_columns) {
                largest = largest.max(self.tiles[row * self.tile_columns + column]);
            }
        }
        largest
    }
}
