//! Crops to the whole picture, row by row.

use super::row::{CropForm, CropRow, KNOT_NUMBERS, knot_sums};
use crate::resolve::balance::{Gains, NO_REST, Scaled, rest};
use crate::resolve::knots::{KnotSums, Knots, SPACING, SharedSums, position};

/// What a whole picture decides of its crops, and makes of them.
pub struct CropJoiner {
    knots: Knots,
    sums: Vec<KnotSums>,
    gains: Gains,
    /// What shares in each cell of a painted picture.
    cells: Vec<SharedSums>,
    rest: [f32; 3],
    is_painted: bool,
}

impl CropJoiner {
    /// A joiner for a picture of `size` columns and rows; `is_painted`: whether anything of it is painted.
    pub fn new(size: [u32; 2], is_painted: bool) -> Self {
        let knots = Knots::new(size.map(|side| side as usize));
        let cells = knots.spans() * knots.size[1].div_ceil(SPACING);
        Self {
            sums: vec![KnotSums::default(); knots.columns() * knots.rows()],
            gains: Gains::neutral(knots),
            cells: vec![SharedSums::default(); cells],
            rest: NO_REST,
            is_painted,
            knots,
        }
    }

    /// The number of knots in a row to which a crop of this width, px, contributes.
    pub fn knot_columns(width: u32) -> usize {
        Knots::new([width as usize, 1]).columns()
    }

    /// Adds what a row brings to the knots: the numbers of each crop that it runs through, by its first column, from left to right. Rows
    /// must follow each other.
    pub fn add_knots<'n>(&mut self, y: u32, crops: impl IntoIterator<Item = (u32, &'n [f32])>) {
        let columns = self.knots.columns();
        let mut row = vec![KnotSums::default(); columns];
        for (first, numbers) in crops {
            let first = first as usize / SPACING;
            for (at, numbers) in (first..).zip(numbers.chunks_exact(KNOT_NUMBERS)) {
                // Two crops share the knot where they meet.
                let here = knot_sums(numbers);
                let sum = row[at].0.as_flattened_mut().iter_mut();
                sum.zip(here.0.as_flattened()).for_each(|(known, here)| *known += here);
            }
        }
        let (before, behind) = position(y as usize);
        for (knot, weight) in [(before, 1.0 - behind), (before + 1, behind)] {
            let sums = &mut self.sums[knot * columns..][..columns];
            sums.iter_mut().zip(&row).for_each(|(sum, here)| sum.add(weight, here));
        }
    }

    /// Computes the gains, once the knots of all rows have been added.
    pub fn find_gains(&mut self) {
        self.gains = Gains::from_sums(self.knots, &self.sums);
    }

    /// Adds the sharing light in a row of a painted picture, once the gains have been computed.
    pub fn add_shared(&mut self, y: u32, row: &mut CropRow) {
        let mut spans = vec![SharedSums::default(); self.knots.spans()];
        let gains = self.gains.row_gains(y as usize, Scaled::Sharing);
        let (parts, shares, pixels) = row.parts_and_pixels();
        parts.share(shares, &gains, pixels, &mut spans);
        let cells = &mut self.cells[y as usize / SPACING * self.knots.spans()..];
        for (cell, SharedSums([before, after])) in cells.iter_mut().zip(&spans) {
            cell.add(before, after);
        }
    }

    /// Finds what is left to give back in a painted picture, once all rows were added.
    pub fn find_rest(&mut self) {
        self.rest = rest(&self.cells);
    }

    /// Makes the pixels of row `y` from the sums in `row`, in place.
    pub fn join(&self, y: u32, form: CropForm, row: &mut CropRow) {
        if self.is_painted {
            let gains = self.gains.row_gains(y as usize, Scaled::Sharing);
            let mut spans = vec![SharedSums::default(); self.knots.spans()];
            let (parts, shares, pixels) = row.parts_and_pixels();
            parts.share(shares, &gains, pixels, &mut spans);
            let (parts, _, pixels) = row.parts_and_pixels();
            return parts.join_shared(self.rest, pixels);
        }
        if form == CropForm::Parts {
            let (parts, shares, pixels) = row.parts_and_pixels();
            parts.join(shares, None, true, pixels);
        }
        self.gains.scale_row(y as usize, &mut row.radiance);
    }
}
