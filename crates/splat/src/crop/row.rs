//! The numbers of a crop's rows.

use crate::resolve::knots::KnotSums;
use crate::resolve::partition::{Parts, Share};
use crate::resolve::parts_to_pixels::Pixels;
use crate::resolve::{BLACK, Light};

/// What a crop stores for each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CropForm {
    /// The picture but for its gains: red, green, blue and coverage. Nothing is painted.
    Evened,
    /// What is free and what shares the rest, four each, and the factors of what shares and of all.
    Parts,
}

/// How many numbers a crop stores per row and knot.
pub const KNOT_NUMBERS: usize = 16;

impl CropForm {
    /// How many numbers each pixel has in this form.
    pub fn numbers(self) -> usize {
        match self {
            Self::Evened => 4,
            Self::Parts => 10,
        }
    }
}

/// A row of the whole picture, put together of those of its crops.
#[derive(Clone, Debug)]
pub struct CropRow {
    /// Of [`CropForm::Parts`].
    pub(super) free: Vec<Light>,
    pub(super) sharing: Vec<Light>,
    pub(super) shares: Vec<Share>,
    /// Linear RGB a pixel; once it is joined, or of [`CropForm::Evened`] but for its gains.
    pub radiance: Vec<[f32; 3]>,
    /// Coverage a pixel.
    pub coverage: Vec<f32>,
}

impl CropRow {
    /// A black row of `width` px.
    pub fn black(width: usize) -> Self {
        Self {
            free: vec![BLACK; width],
            sharing: vec![BLACK; width],
            shares: vec![Share::NONE; width],
            radiance: vec![[0.0; 3]; width],
            coverage: vec![0.0; width],
        }
    }

    /// Puts the numbers of a crop's row in, from column `column` of the whole picture on.
    pub fn set(&mut self, column: usize, form: CropForm, numbers: &[f32]) {
        let pixels = numbers.chunks_exact(form.numbers());
        for (at, numbers) in (column..).zip(pixels) {
            match (form, numbers) {
                (CropForm::Evened, &[r, g, b, coverage]) => {
                    (self.radiance[at], self.coverage[at]) = ([r, g, b], coverage);
                }
                (CropForm::Parts, &[a, b, c, d, e, f, g, h, partial, even]) => {
                    (self.free[at], self.sharing[at]) = ([a, b, c, d], [e, f, g, h]);
                    self.shares[at] = Share { partial, even };
                }
                _ => {}
            }
        }
    }

    pub(super) fn parts_and_pixels(&mut self) -> (Parts<'_>, &[Share], Pixels<'_>) {
        let Self { free, sharing, shares, radiance, coverage } = self;
        (Parts { free, sharing }, shares, Pixels { first: 0, radiance, coverage })
    }
}

/// The contribution of a row to a knot, from its numbers.
pub(super) fn knot_sums(numbers: &[f32]) -> KnotSums {
    let mut sums = KnotSums::default();
    sums.0.as_flattened_mut().iter_mut().zip(numbers).for_each(|(sum, number)| *sum = *number);
    sums
}
