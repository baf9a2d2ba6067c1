//! The colours of what goes on behind and beside the picture: from views that see it; where none does, from around, known as invented.

use crate::cells::Grid;
use crate::error::ReliefError;
use crate::fading::fade;
use crate::frame::Frame;
use crate::hidden::{Hidden, number};
use crate::other_view::OtherView;
use progress::Progress;
use rayon::prelude::*;

/// Texels around the second layer that are filled from it, so that interpolation finds something.
const RIM: usize = 2;
/// A pixel covers those beside it if it reaches into them by so much.
const RIM_SHARE: f32 = 0.25;
/// Rounds in which what was invented is evened out.
const ROUNDS: usize = 32;

/// The second layer's colours, and, by layer and cell, which some view shows.
pub(crate) struct Behind {
    pub colors: Vec<[f32; 3]>,
    pub is_seen: Vec<bool>,
}

/// Cells of the first layer and of what goes on behind it, whose colours are looked for.
pub(crate) struct Surface<'a> {
    pub frame: &'a Frame,
    pub front: &'a [f32],
    pub hidden: &'a Hidden,
    /// The least step of disparity that is a jump.
    pub jump: f32,
}

/// A cell that the picture does not show.
#[derive(Clone, Copy)]
struct Asked {
    cell: usize,
    disparity: f32,
    layer: usize,
}

impl Surface<'_> {
    /// Finds the colours of the second layer, and those of the margin, into `shown`.
    pub fn complete<E: Send>(
        &self,
        shown: &mut [[f32; 3]],
        views: &[OtherView<'_, E>],
        progress: &dyn Progress,
    ) -> Result<Behind, ReliefError<E>> {
        let grid = self.frame.grid;
        let beside = (0..grid.count()).filter(|&cell| !self.frame.is_in_picture(cell));
        let beside = beside.map(|cell| Asked { cell, disparity: self.front[cell], layer: 0 });
        let behind = self.hidden.order.iter();
        let behind = behind.map(|&cell| Asked { cell, disparity: self.hidden.disparity[cell], layer: 1 });
        let asked: Vec<Asked> = beside.chain(behind).filter(|asked| !asked.disparity.is_nan()).collect();
        let sums = self.seen_by_others(&asked, views, progress)?;

        let mut colors = vec![[f32::NAN; 3]; grid.count()];
        let mut is_seen = [vec![true; grid.count()], vec![false; grid.count()]].concat();
        for (asked, sum) in asked.iter().zip(&sums) {
            let is_told = sum[3] > 0.0;
            is_seen[asked.layer * grid.count() + asked.cell] = is_told;
            if is_told {
                let color = [sum[0] / sum[3], sum[1] / sum[3], sum[2] / sum[3]];
                let layer = if asked.layer == 0 { &mut *shown } else { &mut colors };
                layer[asked.cell] = color;
            }
        }
        fade(grid, shown, &is_seen[..grid.count()]);
        invent(grid, shown, self.hidden, &is_seen[grid.count()..], &mut colors);
        fill_rim(grid, &self.hidden.order, &mut colors);
        Ok(Behind { colors, is_seen })
    }

    /// What other views show of cells, summed, and how many do.
    fn seen_by_others<E: Send>(
        &self,
        asked: &[Asked],
        views: &[OtherView<'_, E>],
        progress: &dyn Progress,
    ) -> Result<Vec<[f32; 4]>, ReliefError<E>> {
        let mut sums = vec![[0.0f32; 4]; asked.len()];
        if asked.is_empty() {
            return Ok(sums);
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
                if is_open(grid, &nearest, place, asked.disparity + self.jump)
                    && let Some(color) = interpolated(picture, &shown, place.map(|at| at - margin))
                {
                    (0..3).for_each(|c| sum[c] += color[c]);
                    sum[3] += 1.0;
                }
            });
        }
        Ok(sums)
    }
}

/// Where a view shows a cell's middle, pixels from its upper left corner.
fn place(grid: Grid, cell: usize, disparity: f32, [dx, dy]: [f32; 2]) -> [f32; 2] {
    let (x, y) = ((cell % grid.width) as f32 + 0.5, (cell / grid.width) as f32 + 0.5);
    [x - disparity * dx, y - disparity * dy]
}

/// The disparity of what is nearest in each pixel of a view, as far as the first layer tells.
fn nearest(grid: Grid, front: &[f32], offset: [f32; 2]) -> Vec<f32> {
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

/// Whether nothing of more disparity than `most` is at a place or beside it.
fn is_open(grid: Grid, nearest: &[f32], [x, y]: [f32; 2], most: f32) -> bool {
    let (x, y) = (x.floor() as isize, y.floor() as isize);
    (y - 1..=y + 1).all(|y| {
        (x - 1..=x + 1).all(|x| {
            let is_in = (0..grid.width as isize).contains(&x) && (0..grid.height as isize).contains(&y);
            !is_in || nearest[grid.at(x as usize, y as usize)] <= most
        })
    })
}

/// What a picture shows at a place in it.
fn interpolated(grid: Grid, picture: &[[f32; 3]], [x, y]: [f32; 2]) -> Option<[f32; 3]> {
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

/// Fills what no view shows, from the farther side inward.
fn invent(grid: Grid, picture: &[[f32; 3]], hidden: &Hidden, is_seen: &[bool], colors: &mut [[f32; 3]]) {
    let unseen: Vec<usize> = hidden.order.iter().copied().filter(|&cell| !is_seen[cell]).collect();
    let around = |colors: &[[f32; 3]], cell: usize| {
        let (mut sum, mut count) = ([0.0; 3], 0.0f32);
        for (side, other) in grid.around(cell) {
            let beside = if hidden.onward[cell][number(side)] { picture[other] } else { colors[other] };
            if !beside[0].is_nan() {
                (0..3).for_each(|c| sum[c] += beside[c]);
                count += 1.0;
            }
        }
        (count > 0.0).then(|| sum.map(|sum| sum / count))
    };
    // Inward, then until nothing is left that has a neighbour.
    let mut left = unseen.clone();
    while !left.is_empty() {
        let before = left.len();
        left.retain(|&cell| match around(colors, cell) {
            Some(color) => {
                colors[cell] = color;
                false
            }
            None => true,
        });
        if left.len() == before {
            // Nothing around is known: what stands before it is all there is.
            left.drain(..).for_each(|cell| colors[cell] = picture[cell]);
        }
    }
    for _ in 0..ROUNDS {
        let next: Vec<[f32; 3]> =
            unseen.iter().map(|&cell| around(colors, cell).unwrap_or(colors[cell])).collect();
        unseen.iter().zip(next).for_each(|(&cell, next)| colors[cell] = next);
    }
}

/// Gives texels beside the layer the colours of its border, and all others none.
fn fill_rim(grid: Grid, order: &[usize], colors: &mut [[f32; 3]]) {
    let mut border: Vec<usize> = order.to_vec();
    for _ in 0..RIM {
        let mut found: Vec<(usize, [f32; 3])> = Vec::new();
        for &cell in &border {
            let beside = grid.around(cell).filter(|(_, other)| colors[*other][0].is_nan());
            found.extend(beside.map(|(_, other)| (other, colors[cell])));
        }
        border = found.iter().map(|(cell, _)| *cell).collect();
        for (cell, color) in found {
            colors[cell] = color;
        }
    }
    colors.par_iter_mut().filter(|color| color[0].is_nan()).for_each(|color| *color = [0.0; 3]);
}
