//! Quantities estimated by blocks of texels and interpolated between block centres, so that they are continuous.

use super::texel_grid::Texels;
use glam::DVec2;
use rayon::prelude::*;

/// A grid of square blocks over the atlas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TexelBlocks {
    columns: usize,
    rows: usize,
}

/// Texels along a side of a block.
const BLOCK_TEXELS: usize = 12;
/// Weight of each of the eight surrounding blocks.
const NEIGHBOUR_WEIGHT: f32 = 0.25;

impl TexelBlocks {
    /// Blocks over an atlas with `size` columns and rows of texels.
    pub fn new(size: [u32; 2]) -> Self {
        let [columns, rows] = size.map(|side| (side as usize).div_ceil(BLOCK_TEXELS).max(1));
        Self { columns, rows }
    }

    /// The number of blocks.
    pub fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// The number of the block that contains a texel.
    pub fn block_of(&self, texels: &Texels, texel: usize) -> usize {
        let [x, y] = texels.place(texel).map(|at| at as usize / BLOCK_TEXELS);
        y * self.columns + x
    }

    /// Whether a block is a white square of a chessboard over all blocks.
    pub fn is_even(&self, block: usize) -> bool {
        (block % self.columns + block / self.columns).is_multiple_of(2)
    }

    /// By block: the quotient of sums of products and squares, pooled with the surrounding blocks and clamped to
    /// bounds; the lower bound where there is no evidence.
    pub fn quotients(&self, sums: &[(f32, f32)], [low, high]: [f32; 2]) -> Vec<f32> {
        (0..self.count())
            .map(|block| {
                let (x, y) = (block % self.columns, block / self.columns);
                let (mut product, mut square) = (0.0, 0.0);
                for row in y.saturating_sub(1)..(y + 2).min(self.rows) {
                    for column in x.saturating_sub(1)..(x + 2).min(self.columns) {
                        let share = if row == y && column == x { 1.0 } else { NEIGHBOUR_WEIGHT };
                        product += sums[row * self.columns + column].0 * share;
                        square += sums[row * self.columns + column].1 * share;
                    }
                }
                if square > 0.0 { (product / square).clamp(low, high) } else { low }
            })
            .collect()
    }

    /// Interpolates `values`, one for each block, at all texels: bilinear between the blocks' middles.
    pub fn interpolate_texels(&self, texels: &Texels, values: &[f32]) -> Vec<f32> {
        let middle = |texel: usize| DVec2::from(texels.place(texel).map(f64::from)) + 0.5;
        (0..texels.count()).into_par_iter().map(|texel| self.at(middle(texel), values)).collect()
    }

    /// Interpolates block values at a position of the atlas, in texels from its upper left corner.
    pub fn at(&self, place: DVec2, values: &[f32]) -> f32 {
        let [x, y] = (place / BLOCK_TEXELS as f64 - 0.5).as_vec2().to_array();
        let [left, top] = [x.floor(), y.floor()];
        let at = |column: f32, row: f32| {
            let column = (column.max(0.0) as usize).min(self.columns - 1);
            let row = (row.max(0.0) as usize).min(self.rows - 1);
            values[row * self.columns + column]
        };
        let upper = at(left, top) + (at(left + 1.0, top) - at(left, top)) * (x - left);
        let lower = at(left, top + 1.0) + (at(left + 1.0, top + 1.0) - at(left, top + 1.0)) * (x - left);
        upper + (lower - upper) * (y - top)
    }
}
