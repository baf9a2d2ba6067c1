//! What is laid over a rough picture that is enlarged.

use crate::display::picture_ring::Rectangle;
use lens::Picture;
use rayon::prelude::*;
use std::fmt::Debug;
use std::ops::RangeInclusive;

/// Something that is laid over an enlarged picture.
pub(crate) trait Layer: Debug + Send + Sync {
    /// Lays it over `part`, a rectangle of the enlarged picture.
    fn lay_over(&self, part: &mut Picture, rectangle: &Rectangle);
}

/// Lays something over each pixel of `part`, a rectangle of a picture of so many columns: `pixel` gets what `of_row` is of its row, its place in
/// the part's row, and its place in the picture; it gives the light (RGB, and coverage) that is to be there, how much of the picture's own this
/// replaces, and what is added.
pub(crate) fn lay_over_each<R>(
    part: &mut Picture,
    [columns, rows]: &Rectangle,
    width: usize,
    of_row: impl Fn(u32) -> R + Sync,
    pixel: impl Fn(&R, usize, usize) -> ([f32; 4], f32, [f32; 4]) + Sync,
) {
    let part_width = columns.len().max(1);
    let part_rows = part.radiance.par_chunks_mut(part_width).zip(part.coverage.par_chunks_mut(part_width));
    part_rows.zip(rows.clone()).for_each(|((radiance, coverage), row)| {
        let (of_row, first) = (of_row(row), row as usize * width + columns.start as usize);
        for (offset, (radiance, coverage)) in radiance.iter_mut().zip(coverage).enumerate() {
            let (base, share, detail) = pixel(&of_row, offset, first + offset);
            let shown = |rough: f32, c: usize| rough + (base[c] - rough) * share + detail[c];
            let [r, g, b] = *radiance;
            *radiance = [shown(r, 0).max(0.0), shown(g, 1).max(0.0), shown(b, 2).max(0.0)];
            *coverage = shown(*coverage, 3).clamp(0.0, 1.0);
        }
    });
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
