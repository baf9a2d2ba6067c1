//! Inlier weights over a photograph: by tiles, interpolated between tile centres.

use glam::DVec2;
use scene::View;

/// Tiles along the longer side of a photograph.
const TILES_PER_LONG_SIDE: f64 = 40.0;

/// How far each position of a photograph shows the scene rather than a transient object, in [0, 1].
#[derive(Debug, PartialEq)]
pub(crate) struct InlierMap {
    pub(super) grid: TileGrid,
    pub(super) tiles: Vec<f32>,
}

/// The tiles of a photograph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TileGrid {
    pub columns: usize,
    pub rows: usize,
    /// Side of a tile, px.
    pub side_px: f64,
}

impl TileGrid {
    /// The tiles over a view's picture.
    pub fn new(view: &View) -> Self {
        let [width, height] = view.lens.size_px().map(f64::from);
        let side_px = (width.max(height) / TILES_PER_LONG_SIDE).max(1.0);
        let [columns, rows] = [width, height].map(|side| (side / side_px).ceil() as usize);
        Self { columns, rows, side_px }
    }
}

impl InlierMap {
    /// A map of weight 1 everywhere, for a view's picture.
    pub fn all_inliers(view: &View) -> Self {
        let grid = TileGrid::new(view);
        Self { grid, tiles: vec![1.0; grid.columns * grid.rows] }
    }

    /// A map from the stored weights of its tiles, row by row; `None` if their number does not fit the view.
    pub fn from_tiles(view: &View, tiles: Vec<f32>) -> Option<Self> {
        let grid = TileGrid::new(view);
        (tiles.len() == grid.columns * grid.rows).then_some(Self { grid, tiles })
    }

    /// Weights of the tiles, in [0, 1], row by row.
    pub fn tiles(&self) -> &[f32] {
        &self.tiles
    }

    /// Inlier weight of a pixel position, in [0, 1]: bilinear between the tiles' middles.
    pub fn at(&self, pixel: DVec2) -> f32 {
        let TileGrid { columns, rows, side_px } = self.grid;
        let place = pixel / side_px - 0.5;
        let floor = place.floor();
        let share = (place - floor).as_vec2();
        let at = |dx: i64, dy: i64| {
            let column = (floor.x as i64 + dx).clamp(0, columns as i64 - 1) as usize;
            let row = (floor.y as i64 + dy).clamp(0, rows as i64 - 1) as usize;
            self.tiles[row * columns + column]
        };
        let row = |dy: i64| at(0, dy) + (at(1, dy) - at(0, dy)) * share.x;
        row(0) + (row(1) - row(0)) * share.y
    }

    /// Whether the weight is 1 everywhere.
    pub fn is_all_inliers(&self) -> bool {
        self.tiles.iter().all(|&tile| tile >= 1.0)
    }
}
