//! The aperture's shape, cut finely: what stencils are made from.

use crate::fixed::{ONE, mul_shift};
use glam::{DVec2, DVec4};
use lens::{Aperture, ApertureShape, Run};

/// Rows of a shape with an outline.
const FINE_ROWS: usize = 512;

/// An aperture of radius 1, v up.
pub struct Shape {
    rows: Vec<Vec<Run>>,
    /// Of what lies below each row, and below the end of the last: light as a share of all, and that times u, u² and v.
    moments_below: Vec<DVec4>,
    /// The rows in integers, one after another.
    pub runs: Vec<ShapeRun>,
    /// Where each row's begin, and the end of the last.
    pub firsts: Vec<u32>,
    /// Whether it is a picture, whose rows may be open in several places.
    pub is_picture: bool,
    /// Open area over [−1, 1]², weighted by transmission.
    pub open_area: f64,
    /// Mean of the open area.
    pub mean: DVec2,
    /// Its variance along each axis.
    pub variance: DVec2,
}

/// A run of a shape's row in integers.
#[derive(Clone, Copy, Debug)]
pub struct ShapeRun {
    /// The u of its ends, times 2²⁴.
    pub start: i32,
    /// See `start`.
    pub end: i32,
    /// Times 65536.
    pub transmission: u32,
}

impl ShapeRun {
    fn new(run: &Run) -> Self {
        let fixed = |u: f64| (u * (1 << 24) as f64).round() as i32;
        let transmission = (run.transmission * 65536.0).round() as u32;
        Self { start: fixed(run.start), end: fixed(run.end), transmission }
    }
}

impl Shape {
    /// Cuts an aperture into rows, with its mean, variance and moments.
    pub fn new(aperture: &Aperture) -> Self {
        let cut = aperture.rows(FINE_ROWS);
        let open_area = cut.open_area();
        let rows: Vec<Vec<Run>> = cut.rows.into_iter().map(|row| row.runs).collect();
        let (mut mean, mut square) = (DVec2::ZERO, DVec2::ZERO);
        let height = 2.0 / rows.len() as f64;
        let mut moments_below = vec![DVec4::ZERO];
        for (row, v) in rows.iter().zip(cell_centers(rows.len())) {
            let mut below = moments_below[moments_below.len() - 1];
            for run in row {
                let width = run.end - run.start;
                let share = width * height * run.transmission / open_area;
                let middle = DVec2::new((run.start + run.end) / 2.0, v);
                let squared = middle * middle + DVec2::new(width, height).powf(2.0) / 12.0;
                mean += share * middle;
                square += share * squared;
                below += share * DVec4::new(1.0, middle.x, squared.x, v);
            }
            moments_below.push(below);
        }
        let is_picture = matches!(aperture.shape, ApertureShape::Mask(_));
        let runs = rows.iter().flatten().map(ShapeRun::new).collect();
        let starts = rows.iter().scan(0, |next, row| {
            *next += row.len() as u32;
            Some(*next)
        });
        let firsts = std::iter::once(0).chain(starts).collect();
        let variance = square - mean * mean;
        Self { rows, moments_below, runs, firsts, is_picture, open_area, mean, variance }
    }

    /// Its parts in a grid of `side` × `side` cells of [−1, 1]², those without light left out.
    pub fn parts(&self, side: usize) -> Vec<Part> {
        let mut parts = vec![Part::default(); side * side];
        let height = 2.0 / self.rows.len() as f64;
        for (v, run) in with_middle(&self.rows) {
            let row = (((v + 1.0) / 2.0 * side as f64) as usize).min(side - 1);
            for (column, part) in parts[row * side..(row + 1) * side].iter_mut().enumerate() {
                let [low, high] = [column, column + 1].map(|k| 2.0 * k as f64 / side as f64 - 1.0);
                let (start, end) = (run.start.max(low), run.end.min(high));
                if end > start {
                    let size = DVec2::new(end - start, height);
                    let share = size.x * size.y * run.transmission / self.open_area;
                    part.add(share, DVec2::new((start + end) / 2.0, v), size);
                }
            }
        }
        parts.into_iter().filter(|part| part.share > 0.0).map(Part::about_mean).collect()
    }

    /// Of the light that passes between two heights v, in [−1, 1]: its share of all, and that share times the mean of
    /// u, of u² and of v.
    pub fn moments(&self, [low, high]: [f64; 2]) -> DVec4 {
        let below = |v: f64| {
            let at = self.row_of(v);
            let row = (at as usize).min(self.rows.len() - 1);
            self.moments_below[row].lerp(self.moments_below[row + 1], at - row as f64)
        };
        below(high) - below(low)
    }

    /// The runs between two v, each with how much of its light that is, as a share of all.
    pub fn runs_between(&self, between: [f64; 2]) -> impl Iterator<Item = (&Run, f64)> {
        let [low, high] = between.map(|v| self.row_of(v));
        let first = low as usize;
        let rows = (first..).zip(&self.rows[first..(high.ceil() as usize).max(first)]);
        rows.flat_map(move |(row, runs)| {
            let height = high.min((row + 1) as f64) - low.max(row as f64);
            let area = 2.0 / self.rows.len() as f64 * height;
            runs.iter()
                .map(move |run| (run, area * (run.end - run.start) * run.transmission / self.open_area))
        })
    }

    /// In rows from v = −1; the first or the last edge beyond them.
    fn row_of(&self, v: f64) -> f64 {
        let count = self.rows.len() as f64;
        ((v + 1.0) / 2.0 * count).clamp(0.0, count)
    }

    /// The runs of the row of the aperture that contains the height `v`, in [−1, 1] times 16384.
    #[inline(always)]
    pub fn runs_at(&self, v: i32) -> &[ShapeRun] {
        let count = self.firsts.len() as u32 - 1;
        let row = mul_shift((v + ONE).max(0) as u32, count, 15).min(count - 1) as usize;
        &self.runs[self.firsts[row] as usize..self.firsts[row + 1] as usize]
    }

    /// Share of the open area in each of 16 × 16 cells of the square of `side` ≥ 1 around it, row 0 at its lowest v, with
    /// the mean aperture point of that share.
    pub fn cells(&self, side: f64) -> Vec<(f64, DVec2)> {
        let mut cells = vec![(0.0, DVec2::ZERO); 256];
        let height = 2.0 / self.rows.len() as f64;
        for (v, run) in with_middle(&self.rows) {
            let row = (((v / side + 1.0) * 8.0) as usize).min(15);
            for column in 0..16 {
                let [low, high] = [column, column + 1].map(|k| (k as f64 / 8.0 - 1.0) * side);
                let (start, end) = (run.start.max(low), run.end.min(high));
                if end > start {
                    let share = (end - start) * height * run.transmission / self.open_area;
                    let (total, mean) = &mut cells[row * 16 + column];
                    *mean += share * DVec2::new((start + end) / 2.0, v);
                    *total += share;
                }
            }
        }
        cells.iter_mut().filter(|(share, _)| *share > 0.0).for_each(|(share, mean)| *mean /= *share);
        cells
    }
}

/// A part of an aperture.
#[derive(Clone, Copy, Debug, Default)]
pub struct Part {
    /// Share of the open area.
    pub share: f64,
    /// Its mean.
    pub mean: DVec2,
    /// Its variance along each axis.
    pub variance: DVec2,
}

impl Part {
    fn add(&mut self, share: f64, center: DVec2, size: DVec2) {
        self.share += share;
        self.mean += share * center;
        self.variance += share * (center * center + size * size / 12.0);
    }

    /// From sums of moments to mean and variance.
    fn about_mean(self) -> Self {
        let mean = self.mean / self.share;
        Self { mean, variance: (self.variance / self.share - mean * mean).max(DVec2::ZERO), ..self }
    }
}

/// All runs with the v of the middle of their row.
fn with_middle(rows: &[Vec<Run>]) -> impl Iterator<Item = (f64, &Run)> {
    rows.iter().zip(cell_centers(rows.len())).flat_map(|(row, v)| row.iter().map(move |run| (v, run)))
}

/// The middles of so many rows.
fn cell_centers(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |row| -1.0 + (2 * row + 1) as f64 / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_the_disc_and_the_square() {
        let disc = Shape::new(&ApertureShape::Disc.into());
        assert!((disc.variance - 0.25).abs().max_element() < 1e-4 && disc.mean.length() < 1e-9);
        let square = Shape::new(&ApertureShape::Square.into());
        assert!((square.variance - 1.0 / 3.0).abs().max_element() < 1e-4);
    }

    #[test]
    fn cells_share_the_open_area() {
        for side in [1.0, 2.5] {
            let shape =
                Shape::new(&ApertureShape::Polygon { blades: 5, rotation: 0.3, roundness: 0.2 }.into());
            let cells = shape.cells(side);
            let total: f64 = cells.iter().map(|(share, _)| share).sum();
            let mean: DVec2 = cells.iter().map(|(share, mean)| *share * *mean).sum();
            assert!((total - 1.0).abs() < 1e-9 && mean.distance(shape.mean) < 1e-6);
        }
    }
}
