//! Sums of splats as differences along pixel rows.
//!
//! A splat is written only where each of its pixel rows starts and ends; one running sum a row makes the picture of it.
//! Both ends carry the same integer with opposite signs, so that every row of every splat sums to exactly zero beyond its
//! end: nothing leaks to the rest of the row.

use crate::fixed_point::{QUANTA, quantise};
use crate::trapezoid::{Taps, Trapezoid};
use glam::DVec2;
use std::ops::Range;

/// A rectangle of light on the picture, blurred by the sample's footprint.
#[derive(Clone, Copy, Debug)]
pub struct Rectangle {
    /// Centre, px.
    pub center: DVec2,
    /// Half its sides, px.
    pub half_size: DVec2,
    /// Half the sides of the footprint, px.
    pub footprint: DVec2,
}

/// Differences of C channels a pixel, for the pixel rows `rows` of a picture.
pub struct Band<'a, const C: usize> {
    /// Picture width, px.
    width: usize,
    /// Its rows.
    pub rows: Range<i64>,
    /// Differences, row by row.
    differences: &'a mut [[i64; C]],
    /// Room for the edges of one rectangle.
    edges: [Taps; 2],
}

impl<'a, const C: usize> Band<'a, C> {
    /// The rows `rows` of a picture `width` wide, whose differences are these.
    pub fn new(width: usize, rows: Range<i64>, differences: &'a mut [[i64; C]]) -> Self {
        Self { width, rows, differences, edges: [Taps::new(), Taps::new()] }
    }

    /// Adds (`sign` 1) or takes away (`sign` −1) a rectangle that holds `mass` in all, in px² times value.
    pub fn deposit(&mut self, rectangle: &Rectangle, mass: &[f64; C], sign: i64) {
        let Rectangle { center, half_size, footprint } = rectangle;
        let vertical = Trapezoid::new(center.y, half_size.y, footprint.y);
        let touched = vertical.pixels();
        let rows = touched.start.max(self.rows.start)..touched.end.min(self.rows.end);
        if rows.is_empty() {
            return;
        }
        let horizontal = Trapezoid::new(center.x, half_size.x, footprint.x);
        let columns = horizontal.pixels();
        if columns.end <= 0 || columns.start >= self.width as i64 {
            return;
        }
        let [rising, falling] = &mut self.edges;
        let rise = horizontal.rising(rising);
        let fall = horizontal.falling(falling);
        let density = mass.map(|m| m * horizontal.height() * QUANTA);
        for row in rows {
            let share = vertical.over_pixel(row);
            let plateau = density.map(|d| d * share);
            let start = (row - self.rows.start) as usize * self.width;
            let line = &mut self.differences[start..start + self.width];
            add_edge(line, rise, rising.as_slice(), &plateau, sign);
            add_edge(line, fall, falling.as_slice(), &plateau, -sign);
        }
    }
}

/// Adds an edge of the height `plateau` (in quanta): the last tap takes what rounding left of it.
#[inline(always)]
fn add_edge<const C: usize>(line: &mut [[i64; C]], first: i64, taps: &[f64], plateau: &[f64; C], sign: i64) {
    let mut left = plateau.map(quantise);
    let last = taps.len() - 1;
    for (k, &tap) in taps.iter().enumerate() {
        let column = first + k as i64;
        if column >= line.len() as i64 {
            return;
        }
        let quanta = if k == last { left } else { std::array::from_fn(|c| quantise(plateau[c] * tap)) };
        let pixel = &mut line[column.max(0) as usize];
        for c in 0..C {
            left[c] -= quanta[c];
            pixel[c] = pixel[c].wrapping_add(sign * quanta[c]);
        }
    }
}

/// The running sum of a row of differences.
pub fn running_sum<const C: usize>(line: &[[i64; C]]) -> impl Iterator<Item = [i64; C]> {
    line.iter().scan([0i64; C], |sum, difference| {
        for c in 0..C {
            sum[c] = sum[c].wrapping_add(difference[c]);
        }
        Some(*sum)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn splat(differences: &mut [[i64; 2]], center: DVec2, half: f64, sign: i64) {
        let mut band = Band::new(32, 0..16, differences);
        let rectangle = Rectangle { center, half_size: DVec2::splat(half), footprint: DVec2::new(0.5, 0.25) };
        band.deposit(&rectangle, &[1.0, 1e5], sign);
    }

    #[test]
    fn mass_is_kept_and_nothing_leaks() {
        for (center, half) in
            [(DVec2::new(10.2, 7.7), 0.0), (DVec2::new(15.0, 8.0), 5.3), (DVec2::new(9.5, 9.5), 0.4)]
        {
            let mut differences = vec![[0; 2]; 32 * 16];
            splat(&mut differences, center, half, 1);
            let mut total = 0;
            for line in differences.chunks(32) {
                let row: Vec<_> = running_sum(line).collect();
                assert_eq!(row[31], [0; 2], "nothing is left at the end of the row");
                total += row.iter().map(|p| p[0]).sum::<i64>();
            }
            assert!((total as f64 / QUANTA - 1.0).abs() < 1e-7, "{center} {half}");
        }
    }

    #[test]
    fn what_was_added_can_be_taken_away() {
        let mut differences = vec![[0; 2]; 32 * 16];
        splat(&mut differences, DVec2::new(3.3, 2.1), 6.0, 1);
        assert!(differences.iter().any(|d| *d != [0; 2]));
        splat(&mut differences, DVec2::new(3.3, 2.1), 6.0, -1);
        assert!(differences.iter().all(|d| *d == [0; 2]));
    }

    #[test]
    fn light_from_outside_the_picture_enters() {
        let mut differences = vec![[0; 2]; 32 * 16];
        splat(&mut differences, DVec2::new(-2.0, 8.0), 5.0, 1);
        let row: Vec<_> = running_sum(&differences[8 * 32..9 * 32]).collect();
        assert!(row[0][0] > 0 && row[1][0] > 0 && row[4][0] == 0);
    }
}
