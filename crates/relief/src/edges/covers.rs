//! The occluders in the pixels of another view, projected from the first layer: their coverage of each pixel, and their light.
//!
//! A hidden cell is visible in the views that see farthest behind its occluder, and there it lies next to the occluder's edge: most of the
//! pixels that show it show part of the occluder, too. A cell covers the area of a view's pixel that overlaps with it, times its opacity
//! if it lies on an edge (`matte`): the remaining light of the pixel is that of the cell behind.

use crate::mesh::cells::Grid;
use rayon::prelude::*;

/// Less coverage of a pixel than this is rounding error.
const TOUCHED: f32 = 1e-3;

/// Rows of a view that are covered at a time.
const BAND: usize = 64;

/// The first layer with the opacity of its edges.
#[derive(Clone, Copy)]
pub(crate) struct MattedLayer<'a> {
    /// By cell: disparity, opacity in [0, 1], and colour.
    pub disparity: &'a [f32],
    pub opacity: &'a [f32],
    pub colors: &'a [[f32; 3]],
}

/// What covers a pixel of a view.
#[derive(Clone, Copy)]
pub(crate) struct PixelCover {
    /// The disparity of the nearest surface in it; −∞ where there is none.
    pub nearest: f32,
    /// That of the next surface in it, behind a jump.
    pub next: f32,
    /// The share of the pixel that the nearest surface covers …
    pub share: f32,
    /// … and its light.
    pub light: [f32; 3],
}

impl PixelCover {
    const NONE: Self =
        Self { nearest: f32::NEG_INFINITY, next: f32::NEG_INFINITY, share: 0.0, light: [0.0; 3] };

    /// The share of the pixel that is left for surfaces of a disparity of at most `max_disparity`, and their share of
    /// its light.
    pub fn remaining(&self, color: [f32; 3], max_disparity: f32) -> (f32, [f32; 3]) {
        if self.nearest <= max_disparity {
            return (1.0, color);
        }
        // Two edges in one pixel cannot be separated.
        if self.next > max_disparity || self.share >= 1.0 {
            return (0.0, [0.0; 3]);
        }
        (1.0 - self.share, std::array::from_fn(|c| color[c] - self.light[c]))
    }
}

/// By pixel of the view at this offset, in the grid of cells. `jump` is the least step of disparity that is a jump.
pub(crate) fn covers(grid: Grid, layer: MattedLayer, offset: [f32; 2], jump: f32) -> Vec<PixelCover> {
    let mut project_covers = vec![PixelCover::NONE; grid.count()];
    let moved = |disparity: &f32| (disparity * offset[1]).abs();
    let far = layer.disparity.iter().map(moved).fold(0.0, f32::max).ceil() as usize;
    let far = far.saturating_add(1);
    let bands = project_covers.par_chunks_mut(BAND * grid.width).enumerate();
    bands.for_each(|(band, covers)| {
        let (first, rows) = (band * BAND, covers.len() / grid.width);
        // The pixels of a band come from rows around it.
        let rows = first.saturating_sub(far)..(first + rows).saturating_add(far).min(grid.height);
        let cells = || {
            let cells = rows.start * grid.width..rows.end * grid.width;
            cells.filter(|&cell| !layer.disparity[cell].is_nan())
        };
        let touched = |cell: usize| {
            let place = project_cell(grid, cell, layer.disparity[cell], offset);
            overlapped_pixels(grid, place)
                .map(move |(pixel, share)| (pixel.wrapping_sub(first * grid.width), share))
        };
        for cell in cells() {
            for (pixel, _) in touched(cell) {
                if let Some(cover) = covers.get_mut(pixel) {
                    cover.nearest = cover.nearest.max(layer.disparity[cell]);
                }
            }
        }
        for cell in cells() {
            let disparity = layer.disparity[cell];
            for (pixel, share) in touched(cell) {
                let Some(cover) = covers.get_mut(pixel) else { continue };
                if disparity < cover.nearest - jump {
                    cover.next = cover.next.max(disparity);
                    continue;
                }
                let share = share * layer.opacity[cell];
                cover.share += share;
                (0..3).for_each(|c| cover.light[c] += share * layer.colors[cell][c]);
            }
        }
    });
    project_covers
}

/// Where a view shows a cell's centre, pixels from its upper left corner.
pub(crate) fn project_cell(grid: Grid, cell: usize, disparity: f32, [dx, dy]: [f32; 2]) -> [f32; 2] {
    let (x, y) = ((cell % grid.width) as f32 + 0.5, (cell / grid.width) as f32 + 0.5);
    [x - disparity * dx, y - disparity * dy]
}

/// The pixels that a cell around this position overlaps, and the overlap with each.
pub(crate) fn overlapped_pixels(grid: Grid, [x, y]: [f32; 2]) -> impl Iterator<Item = (usize, f32)> {
    let (left, above) = ((x - 0.5).floor(), (y - 0.5).floor());
    let (right, below) = (x - 0.5 - left, y - 0.5 - above);
    let at_offset = move |dx: isize, dy: isize| {
        let share = |after: f32, is_after: bool| if is_after { after } else { 1.0 - after };
        let share = share(right, dx == 1) * share(below, dy == 1);
        let (x, y) = ((left as isize).saturating_add(dx), (above as isize).saturating_add(dy));
        let is_in = (0..grid.width as isize).contains(&x) && (0..grid.height as isize).contains(&y);
        (is_in && share > TOUCHED).then(|| (grid.at(x as usize, y as usize), share))
    };
    [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().filter_map(move |(dx, dy)| at_offset(dx, dy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_behind_is_left_at_an_edge() {
        // A card's last column has an opacity of 0.4; the view shows it half a pixel further left.
        let grid = Grid { width: 6, height: 1 };
        let layer = MattedLayer {
            disparity: &[0.5, 0.5, 0.5, 0.0, 0.0, 0.0],
            opacity: &[1.0, 1.0, 0.4, 1.0, 1.0, 1.0],
            colors: &[[0.8; 3]; 6],
        };
        let covers = covers(grid, layer, [1.0, 0.0], 0.25);
        let shares: Vec<f32> = covers.iter().map(|cover| cover.share).collect();
        let expected = [1.0, 0.7, 0.2, 1.0, 1.0, 1.0];
        assert!(
            shares.iter().zip(expected).all(|(share, expected)| (share - expected).abs() < 1e-6),
            "{shares:?}"
        );
        // Behind it is 0.1.
        let color = [0.7 * 0.8 + 0.3 * 0.1; 3];
        let (open, light) = covers[1].remaining(color, 0.25);
        assert!((open - 0.3).abs() < 1e-6 && (light[0] / open - 0.1).abs() < 1e-5, "{open} {light:?}");
        assert_eq!(covers[0].remaining([0.8; 3], 0.25).0, 0.0);
        assert_eq!(covers[4].remaining([0.3; 3], 0.25), (1.0, [0.3; 3]));
    }
}
