//! A picture in brighter or dimmer light of the world, as far as that can be told from pictures without blur.
//!
//! Light is linear: where the world's is multiplied by b, and other light is not, what a point sends grows by a factor between 1 and b. Blurred
//! pictures are multiplied by that factor as the pinhole pictures before and after show it, over cells so large that noise and blur do not matter.

use crate::display::layer::{Layer, neighbours};
use crate::display::picture_ring::Rectangle;
use lens::Picture;
use rayon::prelude::*;

/// Cells in a picture's width.
const CELLS_ACROSS: u32 = 32;

/// By how much brighter light makes a picture, cell by cell.
#[derive(Debug)]
pub(crate) struct LightRatio {
    /// Columns and rows of the cells.
    size: [u32; 2],
    /// Columns and rows of the picture that it is laid over.
    picture_size: [u32; 2],
    factors: Vec<[f32; 3]>,
}

impl LightRatio {
    /// From pictures without blur, `before` and after the world's light was multiplied by `brightness` (positive and finite), for pictures of
    /// `picture_size` columns and rows.
    pub fn new([before, after]: [&Picture; 2], brightness: f32, picture_size: [u32; 2]) -> Self {
        let [columns, rows] = [before.width, before.height];
        let across = CELLS_ACROSS.min(columns);
        let down = (across * rows).div_ceil(columns).clamp(1, rows);
        let sums = [before, after].map(|picture| sums_of_cells(picture, [across, down]));
        let bounds = [brightness.min(1.0), brightness.max(1.0)];
        let factor = |cell: usize| {
            std::array::from_fn(|c| {
                let growth = sums[1][cell][c] / sums[0][cell][c];
                // Of what was black, or is no number, nothing is known: so it stays.
                if growth.is_finite() { growth.clamp(bounds[0], bounds[1]) } else { 1.0 }
            })
        };
        let factors = (0..sums[0].len()).map(factor).collect();
        Self { size: [across, down], picture_size, factors }
    }
}

impl Layer for LightRatio {
    fn lay_over(&self, part: &mut Picture, [columns, rows]: &Rectangle) {
        let place = |at: u32, axis: usize| neighbours(at, self.picture_size[axis], self.size[axis]);
        let across: Vec<_> = columns.clone().map(|column| place(column, 0)).collect();
        let cells_across = self.size[0] as usize;
        let mixed = |a: f32, b: f32, share: f32| a + (b - a) * share;
        let lines = part.radiance.par_chunks_mut(columns.len().max(1)).zip(rows.clone());
        lines.for_each(|(radiance, row)| {
            let (between, v) = place(row, 1);
            let [above, below] = between.map(|row| &self.factors[row * cells_across..][..cells_across]);
            for (radiance, ([left, right], u)) in radiance.iter_mut().zip(&across) {
                for (c, light) in radiance.iter_mut().enumerate() {
                    let along = |factors: &[[f32; 3]]| mixed(factors[*left][c], factors[*right][c], *u);
                    *light *= mixed(along(above), along(below), v);
                }
            }
        });
    }
}

/// The light of each cell, with that of the cells beside it.
fn sums_of_cells(picture: &Picture, [across, down]: [u32; 2]) -> Vec<[f32; 3]> {
    let mut sums = vec![[0.0; 3]; (across * down) as usize];
    for (index, radiance) in (0..).zip(&picture.radiance) {
        let column = (index % picture.width) * across / picture.width;
        let row = (index / picture.width) * down / picture.height;
        for y in row.saturating_sub(1)..(row + 2).min(down) {
            for x in column.saturating_sub(1)..(column + 2).min(across) {
                let sum: &mut [f32; 3] = &mut sums[(y * across + x) as usize];
                (0..3).for_each(|c| sum[c] += radiance[c]);
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_world_lights_changes_and_lamps_do_not() {
        // The left half is lit by a lamp, the right by the world; the light of single pixels is noise.
        let picture = |brightness: f32| {
            let mut picture = Picture::black(160, 90);
            for (index, radiance) in picture.radiance.iter_mut().enumerate() {
                let noise = 1.0 + 0.5 * ((index * 7919 % 11) as f32 / 5.0 - 1.0);
                *radiance = [if index % 160 < 80 { 0.4 } else { 0.3 * brightness * noise }; 3];
            }
            picture
        };
        let size = [640, 360];
        let ratio = LightRatio::new([&picture(1.0), &picture(3.0)], 3.0, size);
        let mut shown = Picture::black(size[0], 1);
        shown.radiance.fill([0.1, 0.2, 0.0]);
        ratio.lay_over(&mut shown, &[0..size[0], 100..101]);
        let near = |a: f32, b: f32| (a - b).abs() < 0.01;
        assert!(shown.radiance[..270].iter().all(|&[r, g, b]| near(r, 0.1) && near(g, 0.2) && b == 0.0));
        assert!(shown.radiance[370..].iter().all(|&[r, g, _]| near(r, 0.3) && near(g, 0.6)));
    }

    #[test]
    fn noise_and_what_was_black_stay_within_what_light_can_do() {
        let (before, mut after) = (Picture::black(3, 2), Picture::black(3, 2));
        after.radiance.fill([9.0, f32::NAN, 0.0]);
        let ratio = LightRatio::new([&before, &after], 2.0, [6, 4]);
        assert!(ratio.factors.iter().all(|factor| *factor == [1.0; 3]));
        let ratio = LightRatio::new([&after, &before], 0.5, [6, 4]);
        assert!(ratio.factors.iter().all(|factor| *factor == [0.5, 1.0, 1.0]));
    }
}
