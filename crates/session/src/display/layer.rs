//! What is laid over a rough picture that is enlarged.

use crate::display::picture_ring::Rectangle;
use lens::Picture;
use rayon::prelude::*;
use std::fmt::Debug;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Something that is laid over an enlarged picture.
pub(crate) trait Layer: Debug + Send + Sync {
    /// Lays it over `part`, a rectangle of the enlarged picture.
    fn lay_over(&self, part: &mut Picture, rectangle: &Rectangle);
}

/// A picture that is laid over others of its size, here more and there less.
#[derive(Debug)]
pub(crate) struct PictureLayer {
    picture: Arc<Picture>,
    /// Columns and rows of the shares.
    size: [u32; 2],
    /// How much of what lies below is replaced, 0 to 1.
    shares: Vec<f32>,
}

impl PictureLayer {
    /// `picture` by `shares` of `size` columns and rows, between which they change linearly.
    pub fn new(picture: Arc<Picture>, size: [u32; 2], shares: Vec<f32>) -> Self {
        debug_assert_eq!(shares.len(), size[0] as usize * size[1] as usize);
        Self { picture, size, shares }
    }
}

impl Layer for PictureLayer {
    fn lay_over(&self, part: &mut Picture, [columns, rows]: &Rectangle) {
        let Picture { width, height, .. } = *self.picture;
        let across: Vec<_> = columns.clone().map(|x| neighbours(x, width, self.size[0])).collect();
        let row_shares = |row: u32| {
            let columns = self.size[0] as usize;
            let ([above, below], v) = neighbours(row, height, self.size[1]);
            let [above, below] = [above, below].map(|row| &self.shares[row * columns..][..columns]);
            let share = |column: usize| above[column] + (below[column] - above[column]) * v;
            (0..columns).map(share).collect::<Vec<f32>>()
        };
        let part_width = columns.len().max(1);
        let part_rows =
            part.radiance.par_chunks_mut(part_width).zip(part.coverage.par_chunks_mut(part_width));
        part_rows.zip(rows.clone()).for_each(|((radiance, coverage), row)| {
            let (shares, first) = (row_shares(row), row as usize * width as usize + columns.start as usize);
            let pixels = radiance.iter_mut().zip(coverage).zip(&across);
            for (index, ((radiance, coverage), ([left, right], u))) in (first..).zip(pixels) {
                let share = shares[*left] + (shares[*right] - shares[*left]) * u;
                let own = self.picture.radiance[index];
                for c in 0..3 {
                    radiance[c] += (own[c] - radiance[c]) * share;
                }
                *coverage += (self.picture.coverage[index] - *coverage) * share;
            }
        });
    }
}

/// 1 for what is below a range, 0 for what is above it.
pub(crate) fn share_below(value: f32, range: &RangeInclusive<f32>) -> f32 {
    1.0 - ((value - range.start()) / (range.end() - range.start())).clamp(0.0, 1.0)
}

/// The pixels of a row of `own` that one of `size` lies between, and how far toward the second.
pub(crate) fn neighbours(at: u32, size: u32, own: u32) -> ([usize; 2], f32) {
    let place = ((at as f32 + 0.5) * own as f32 / size as f32 - 0.5).clamp(0.0, own as f32 - 1.0);
    ([place as usize, (place as usize + 1).min(own as usize - 1)], place.fract())
}
