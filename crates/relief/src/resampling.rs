//! Colours of places that are hidden in the picture, resampled from other views.

use crate::color_stats::{ColorAccumulator, ColorStats};
use crate::edges::covers::{MattedLayer, PixelCover, covers, overlapped_pixels, project_cell};
use crate::error::ReliefError;
use crate::frame::Frame;
use crate::mesh::cells::Grid;
use crate::other_view::OtherView;
use progress::Progress;
use rayon::prelude::*;

/// The least overlap with which a pixel covers its neighbour.
const RIM_SHARE: f32 = 0.25;
/// The weight of colours from pixels at edges of occluders, relative to others: edges are slightly misplaced.
const BESIDE_EDGES: f32 = 0.2;
/// A view where less than this share of the pixel is left does not count.
const LEAST_LEFT: f32 = 0.05;

/// A place that the picture does not show.
#[derive(Clone, Copy)]
pub(crate) struct TexelQuery {
    pub cell: usize,
    pub disparity: f32,
}

/// The first layer, which other views observe.
pub(crate) struct FrontLayer<'a> {
    pub frame: &'a Frame,
    pub front: &'a [f32],
    /// The least step of disparity that is a jump.
    pub jump: f32,
}

impl FrontLayer<'_> {
    /// The colours of places in other views, where one shows them; in pixels that they share with an occluder, from
    /// the remaining light.
    ///
    /// # Errors
    /// A view cannot be read, or `progress` asks to stop.
    pub fn collect_color_stats<E: Send>(
        &self,
        queries: &[TexelQuery],
        before: MattedLayer,
        views: &[&OtherView<'_, E>],
        progress: &dyn Progress,
    ) -> Result<Vec<Option<ColorStats>>, ReliefError<E>> {
        let mut sums = vec![ColorAccumulator::default(); queries.len()];
        if queries.is_empty() {
            return Ok(Vec::new());
        }
        let (grid, margin) = (self.frame.grid, self.frame.margin as f32);
        let [width, height] = self.frame.picture();
        let picture = Grid { width, height };
        for (done, view) in views.iter().enumerate() {
            progress.check().map_err(ReliefError::Cancelled)?;
            progress.report(done as f32 / views.len() as f32);
            let shown = (view.read)().map_err(ReliefError::View)?;
            // A picture of another size cannot be sampled.
            if shown.len() != picture.count() {
                continue;
            }
            let covers = covers(grid, before, view.offset, self.jump);
            sums.par_iter_mut().zip(queries).for_each(|(sum, query)| {
                let max_disparity = query.disparity + self.jump;
                let place = project_cell(grid, query.cell, query.disparity, view.offset);
                if !is_inside(picture, place.map(|at| at - margin)) {
                    return;
                }
                let (mut left, mut light) = (0.0, [0.0; 3]);
                for (pixel, share) in overlapped_pixels(grid, place) {
                    // The border is extended.
                    let color = shown[self.frame.pixel(pixel)];
                    let (open, of_pixel) = covers[pixel].remaining(color, max_disparity);
                    left += share * open;
                    (0..3).for_each(|c| light[c] += share * of_pixel[c]);
                }
                if left < LEAST_LEFT {
                    return;
                }
                let weight = if is_clear(grid, &covers, place, max_disparity) { 1.0 } else { BESIDE_EDGES };
                sum.add(light.map(|light| (light / left).max(0.0)), left * left * weight);
            });
        }
        Ok(sums.iter().map(ColorAccumulator::stats).collect())
    }
}

/// The disparity of the nearest surface in each pixel of a view, projected from the first layer.
pub(crate) fn nearest_disparity(grid: Grid, front: &[f32], offset: [f32; 2]) -> Vec<f32> {
    let mut nearest = vec![f32::NEG_INFINITY; grid.count()];
    for (cell, &disparity) in front.iter().enumerate().filter(|(_, disparity)| !disparity.is_nan()) {
        // It covers the pixels whose centres are nearer to its own than a pixel's width, except for a rim that is
        // less than noise.
        let [columns, rows] = project_cell(grid, cell, disparity, offset).map(|at| {
            let first = (at - 0.5).floor();
            let share = at - 0.5 - first;
            [
                (share < 1.0 - RIM_SHARE).then_some(first as isize),
                (share > RIM_SHARE).then_some((first as isize).saturating_add(1)),
            ]
        });
        for y in rows.into_iter().flatten().filter(|y| (0..grid.height as isize).contains(y)) {
            for x in columns.into_iter().flatten().filter(|x| (0..grid.width as isize).contains(x)) {
                let there = &mut nearest[grid.at(x as usize, y as usize)];
                *there = there.max(disparity);
            }
        }
    }
    nearest
}

/// Whether nothing of more disparity than `max_disparity` is at a position or next to it.
fn is_clear(grid: Grid, covers: &[PixelCover], [x, y]: [f32; 2], max_disparity: f32) -> bool {
    let (x, y) = (x.floor() as isize, y.floor() as isize);
    (y - 1..=y + 1).all(|y| {
        (x - 1..=x + 1).all(|x| {
            let is_in = (0..grid.width as isize).contains(&x) && (0..grid.height as isize).contains(&y);
            !is_in || covers[grid.at(x as usize, y as usize)].nearest <= max_disparity
        })
    })
}

/// Whether a position is in a picture.
fn is_inside(picture: Grid, [x, y]: [f32; 2]) -> bool {
    x >= 0.0 && y >= 0.0 && x <= picture.width as f32 && y <= picture.height as f32
}

/// The bilinearly interpolated colour at a position; `None` outside the picture.
pub(crate) fn interpolate(grid: Grid, picture: &[[f32; 3]], [x, y]: [f32; 2]) -> Option<[f32; 3]> {
    if !is_inside(grid, [x, y]) {
        return None;
    }
    let (x, y) = (x - 0.5, y - 0.5);
    let (left, above) = (x.floor(), y.floor());
    let (right, below) = (x - left, y - above);
    let at = |dx: isize, dy: isize| {
        let column = (left as isize + dx).clamp(0, grid.width as isize - 1) as usize;
        let row = (above as isize + dy).clamp(0, grid.height as isize - 1) as usize;
        picture[grid.at(column, row)]
    };
    let [a, b, c, d] = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
    let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
    Some(std::array::from_fn(|k| mix(mix(a[k], b[k], right), mix(c[k], d[k], right), below)))
}
