//! What sharing and evening do to the light around knots that lie all over the picture: what gains are found from.

use crate::resolve::Light;
use crate::resolve::partition::{Parts, Share};
use glam::Vec4;
use numerics::with_widest_simd;
use rayon::prelude::*;

/// How far knots lie apart, px. What is taken from a surface is given back within that of it.
pub const SPACING: usize = 32;

/// Red, green, blue and coverage of the standard picture, weighted by a knot's tent: of sharing samples before and after
/// they share, of the picture before that and after it is evened out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KnotSums(pub [[f32; 4]; 4]);

impl KnotSums {
    /// Adds other sums times `weight`.
    pub fn add(&mut self, weight: f32, other: &Self) {
        for (sum, other) in self.0.as_flattened_mut().iter_mut().zip(other.0.as_flattened()) {
            *sum += weight * other;
        }
    }
}

/// Red, green, blue and coverage of sharing samples before and after they share and are scaled by their gains.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SharedSums(pub [Light; 2]);

impl SharedSums {
    /// Sums that take turns, a pixel each: none waits for the one before.
    pub const TURNS: usize = 2;

    /// Adds a pixel's light before and after it was evened.
    #[inline(always)]
    pub fn add(&mut self, before: &Light, after: &Light) {
        for c in 0..4 {
            self.0[0][c] += before[c];
            self.0[1][c] += after[c];
        }
    }

    /// The sum over all turns.
    #[inline(always)]
    pub fn from_turns([mut sum, second]: [Self; Self::TURNS]) -> Self {
        let [before, after] = &second.0;
        sum.add(before, after);
        sum
    }
}

/// The knots of a picture, row by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Knots {
    /// Of the picture, px.
    pub size: [usize; 2],
}

/// A pixel's place among knots: the one before it, and the weight of the one behind.
#[inline(always)]
pub const fn position(pixel: usize) -> (usize, f32) {
    (pixel / SPACING, ((pixel % SPACING) as f32 + 0.5) / SPACING as f32)
}

impl Knots {
    /// The knots of a picture of `size` columns and rows.
    pub fn new(size: [usize; 2]) -> Self {
        Self { size }
    }

    /// The number of knots in a row.
    pub fn columns(&self) -> usize {
        self.size[0].div_ceil(SPACING) + 1
    }

    /// The number of rows of knots.
    pub fn rows(&self) -> usize {
        self.size[1].div_ceil(SPACING) + 1
    }

    /// The number of spans of [`SPACING`] pixels in a row of pixels.
    pub fn spans(&self) -> usize {
        self.columns() - 1
    }

    /// Sums a whole row of pixels: a sum for each column of knots. Those of the picture, beside those of what shares, only if
    /// asked for.
    pub fn sum_row(&self, parts: Parts<'_>, shares: &[Share], sums: &mut [KnotSums], has_picture: bool) {
        if has_picture {
            with_widest_simd(
                #[inline(always)]
                || sum_pixels::<true>(parts, shares, sums),
            );
        } else {
            with_widest_simd(
                #[inline(always)]
                || sum_pixels::<false>(parts, shares, sums),
            );
        }
    }

    /// The sums of all knots, row by row, from those of all rows of pixels.
    pub fn sums(&self, rows: &[KnotSums]) -> Vec<KnotSums> {
        let columns = self.columns();
        let sum = |knot: usize| {
            let (row, column) = (knot / columns, knot % columns);
            let mut sum = KnotSums::default();
            for y in (row.max(1) - 1) * SPACING..((row + 1) * SPACING).min(self.size[1]) {
                let (before, behind) = position(y);
                sum.add(if before == row { 1.0 - behind } else { behind }, &rows[y * columns + column]);
            }
            sum
        };
        (0..columns * self.rows()).into_par_iter().map(sum).collect()
    }

    /// The sums of cells of [`SPACING`] rows from those of the spans of all rows of pixels.
    pub fn cells(&self, spans: &[SharedSums]) -> Vec<SharedSums> {
        let of_rows = spans.chunks(SPACING * self.spans());
        let cell = |rows: &[SharedSums], span: usize| {
            let mut sum = SharedSums::default();
            rows[span..]
                .iter()
                .step_by(self.spans())
                .for_each(|SharedSums([before, after])| sum.add(before, after));
            sum
        };
        of_rows.flat_map(|rows| (0..self.spans()).map(move |span| cell(rows, span))).collect()
    }
}

/// Some light of the pixels of a span.
#[derive(Clone, Copy, Default)]
struct SpanSum {
    sum: Vec4,
    /// The sum of all sums so far: a pixel is in it as often as there are pixels from it to the span's end.
    ramp: Vec4,
}

impl SpanSum {
    #[inline(always)]
    fn add(&mut self, light: Vec4) {
        self.sum += light;
        self.ramp += self.sum;
    }

    /// Weighted by the tents of the knot before the span and of the one behind it, if that many pixels were added.
    fn weighted_ends(mut self, count: usize) -> [Vec4; 2] {
        (count..SPACING).for_each(|_| self.add(Vec4::ZERO));
        let before = (self.ramp - 0.5 * self.sum) / SPACING as f32;
        [before, self.sum - before]
    }
}

#[inline(always)]
fn sum_pixels<const HAS_PICTURE: bool>(parts: Parts<'_>, shares: &[Share], sums: &mut [KnotSums]) {
    let lights = parts.free.chunks(SPACING).zip(parts.sharing.chunks(SPACING));
    let mut of_knot = [Vec4::ZERO; 4];
    for (((free, sharing), shares), sum) in lights.zip(shares.chunks(SPACING)).zip(&mut *sums) {
        let [mut before, mut after, mut picture, mut evened] = [SpanSum::default(); 4];
        for ((free, sharing), share) in free.iter().zip(sharing).zip(shares) {
            let (free, sharing) = (Vec4::from_array(*free), Vec4::from_array(*sharing));
            let shared = share.partial * sharing;
            before.add(sharing);
            after.add(shared);
            if HAS_PICTURE {
                picture.add(free + sharing);
                evened.add(share.even * (free + shared));
            }
        }
        let ends = [before, after, picture, evened].map(|sum| sum.weighted_ends(free.len()));
        for ((sum, of_knot), [before, behind]) in sum.0.iter_mut().zip(&mut of_knot).zip(ends) {
            *sum = (*of_knot + before).to_array();
            *of_knot = behind;
        }
    }
    if let Some(last) = sums.last_mut() {
        last.0 = of_knot.map(|sum| sum.to_array());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A highlight anywhere in a row, at a knot or between two, at the row's end too, is weighted as if it were alone.
    #[test]
    fn rows_are_weighted_by_tents() {
        const WIDTH: usize = 75;
        let knots = Knots::new([WIDTH, 1]);
        let share = Share { partial: 0.5, even: 0.25 };
        for highlight in 0..WIDTH {
            let light = |x: usize| if x == highlight { [1e6; 4] } else { [1e-3; 4] };
            let lights: Vec<_> = (0..WIDTH).map(light).collect();
            let mut sums = vec![KnotSums::default(); knots.columns()];
            knots.sum_row(Parts { free: &lights, sharing: &lights }, &[share; WIDTH], &mut sums, true);
            for (knot, sums) in sums.iter().enumerate() {
                let tent = |x: usize| 1.0 - (knot as f64 - (x as f64 + 0.5) / SPACING as f64).abs();
                let sum = (0..WIDTH).map(|x| tent(x).max(0.0) * f64::from(light(x)[0])).sum::<f64>();
                for (of_kind, factor) in sums.0.iter().zip([1.0, 0.5, 2.0, 0.375]) {
                    let ratio = f64::from(of_kind[0]) / (factor * sum);
                    assert!((ratio - 1.0).abs() < 1e-5, "{highlight} {knot}: {ratio}");
                }
            }
        }
    }
}
