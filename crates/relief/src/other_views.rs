//! What other views show of places that the picture does not.

use crate::cells::Grid;
use crate::error::ReliefError;
use crate::frame::Frame;
use crate::look::{Look, Looks};
use crate::other_view::OtherView;
use progress::Progress;
use rayon::prelude::*;

/// A pixel covers those beside it if it reaches into them by so much.
const RIM_SHARE: f32 = 0.25;
/// Views in which something nearer is two pixels off count so little beside those in which it is farther: edges are mixed.
const BESIDE_EDGES: f32 = 1e-3;

/// A place that the picture does not show.
#[derive(Clone, Copy)]
pub(crate) struct Asked {
    pub cell: usize,
    pub disparity: f32,
}

/// What views look at: the first layer.
pub(crate) struct Seen<'a> {
    pub frame: &'a Frame,
    pub front: &'a [f32],
    /// The least step of disparity that is a jump.
    pub jump: f32,
}

impl Seen<'_> {
    /// What other views show of places, where one does.
    pub fn looks<E: Send>(
        &self,
        asked: &[Asked],
        views: &[OtherView<'_, E>],
        progress: &dyn Progress,
    ) -> Result<Vec<Option<Look>>, ReliefError<E>> {
        let mut sums = vec![Looks::default(); asked.len()];
        if asked.is_empty() {
            return Ok(Vec::new());
        }
        let (grid, margin) = (self.frame.grid, self.frame.margin as f32);
        let [width, height] = self.frame.picture();
        let picture = Grid { width, height };
        for (done, view) in views.iter().enumerate() {
            progress.check().map_err(ReliefError::Cancelled)?;
            progress.report(done as f32 / views.len() as f32);
            let shown = (view.read)().map_err(ReliefError::View)?;
            // A picture of another size shows nothing that could be found in it.
            if shown.len() != picture.count() {
                continue;
            }
            let nearest = nearest(grid, self.front, view.offset);
            sums.par_iter_mut().zip(asked).for_each(|(sum, asked)| {
                let place = place(grid, asked.cell, asked.disparity, view.offset);
                let is_open = |around| is_open(grid, &nearest, place, around, asked.disparity + self.jump);
                let weight = match (is_open(1), is_open(2)) {
                    (false, _) => return,
                    (true, false) => BESIDE_EDGES,
                    (true, true) => 1.0,
                };
                if let Some(color) = interpolated(picture, &shown, place.map(|at| at - margin)) {
                    sum.add(color, weight);
                }
            });
        }
        Ok(sums.iter().map(Looks::look).collect())
    }
}

/// Where a view shows a cell's middle, pixels from its upper left corner.
pub(crate) fn place(grid: Grid, cell: usize, disparity: f32, [dx, dy]: [f32; 2]) -> [f32; 2] {
    let (x, y) = ((cell % grid.width) as f32 + 0.5, (cell / grid.width) as f32 + 0.5);
    [x - disparity * dx, y - disparity * dy]
}

/// The disparity of what is nearest in each pixel of a view, as far as the first layer tells.
pub(crate) fn nearest(grid: Grid, front: &[f32], offset: [f32; 2]) -> Vec<f32> {
    let mut nearest = vec![f32::NEG_INFINITY; grid.count()];
    for (cell, &disparity) in front.iter().enumerate().filter(|(_, disparity)| !disparity.is_nan()) {
        // It covers the pixels whose middles are nearer to its own than they are wide, but for a rim that is less than noise.
        let [columns, rows] = place(grid, cell, disparity, offset).map(|at| {
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

/// Whether nothing of more disparity than `most` is at a place or `around` it.
fn is_open(grid: Grid, nearest: &[f32], [x, y]: [f32; 2], around: isize, most: f32) -> bool {
    let (x, y) = (x.floor() as isize, y.floor() as isize);
    (y - around..=y + around).all(|y| {
        (x - around..=x + around).all(|x| {
            let is_in = (0..grid.width as isize).contains(&x) && (0..grid.height as isize).contains(&y);
            !is_in || nearest[grid.at(x as usize, y as usize)] <= most
        })
    })
}

/// What a picture shows at a place in it.
pub(crate) fn interpolated(grid: Grid, picture: &[[f32; 3]], [x, y]: [f32; 2]) -> Option<[f32; 3]> {
    let is_in = x >= 0.0 && y >= 0.0 && x <= grid.width as f32 && y <= grid.height as f32;
    if !is_in {
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
