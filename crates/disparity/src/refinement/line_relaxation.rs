//! Weighted least squares on the grid of pixels with smoothness between neighbours, line by line.
//!
//! A row whose neighbours above and below are fixed is a tridiagonal system: solved exactly in one pass there and back. Rows and columns in
//! turn propagate values across plain surfaces in a few rounds (line relaxation; Min et al., *Fast Global Image Smoothing Based on
//! Weighted Least Squares*, TIP 2014, section III for lines), and across the whole picture if coarser grids are solved first. Columns
//! are rows of the transposed picture.

use rayon::prelude::*;

/// The shortest side of the coarsest grid, pixels; there so many times as many rounds cost nothing.
const COARSEST: usize = 8;

/// The smoothness weights between neighbours.
pub struct Bonds {
    width: usize,
    /// Between each pixel and the one to its right, row by row; 0 in the last column.
    along_rows: Vec<f32>,
    /// Between each pixel and the one below, column by column; 0 in the last row.
    along_columns: Vec<f32>,
}

impl Bonds {
    /// The bonds that `bond_between` returns for the indices of neighbouring pixels, in a picture of `width` ×
    /// `height` px.
    pub fn new(width: usize, height: usize, bond_between: impl Fn(usize, usize) -> f32 + Sync) -> Self {
        let mut along_rows = vec![0.0; width * height];
        along_rows.par_chunks_mut(width).enumerate().for_each(|(y, bonds)| {
            for (x, bond) in bonds[..width - 1].iter_mut().enumerate() {
                *bond = bond_between(y * width + x, y * width + x + 1);
            }
        });
        let mut along_columns = vec![0.0; width * height];
        along_columns.par_chunks_mut(height).enumerate().for_each(|(x, bonds)| {
            for (y, bond) in bonds[..height - 1].iter_mut().enumerate() {
                *bond = bond_between(y * width + x, (y + 1) * width + x);
            }
        });
        Self { width, along_rows, along_columns }
    }

    /// Computes values near the minimum that [`Bonds::relax`] converges to, wherever they start: first on every second pixel of every second
    /// line, and so on. Omitted pixels count as far as they are bonded to those that remain, so that thin objects and the surface behind
    /// them are not merged.
    pub fn solve_coarse_to_fine(
        &self,
        values: &mut Vec<f32>,
        certainty: &[f32],
        target: &[f32],
        rounds: usize,
    ) {
        let (width, height) = (self.width, values.len() / self.width);
        let is_coarsest = width.min(height) < 2 * COARSEST;
        if !is_coarsest {
            let coarse = self.halved(height);
            let [columns, rows] = [width.div_ceil(2), height.div_ceil(2)];
            let (coarse_certainty, coarse_target): (Vec<f32>, Vec<f32>) = (0..columns * rows)
                .into_par_iter()
                .map(|at| self.pooled([at % columns * 2, at / columns * 2], height, certainty, target))
                .unzip();
            let mut start: Vec<f32> =
                (0..columns * rows).map(|at| values[at / columns * 2 * width + at % columns * 2]).collect();
            coarse.solve_coarse_to_fine(&mut start, &coarse_certainty, &coarse_target, rounds);
            values.par_chunks_mut(width).enumerate().for_each(|(y, values)| {
                let row = &start[y / 2 * columns..][..columns];
                values.iter_mut().enumerate().for_each(|(x, value)| *value = row[x / 2]);
            });
        }
        let rounds = if is_coarsest { COARSEST * rounds } else { rounds };
        self.relax(values, certainty, target, rounds);
    }

    /// The weight and the target of a pixel pooled with those to the right, below and between: those count through
    /// their bonds with it.
    fn pooled(&self, [x, y]: [usize; 2], height: usize, certainty: &[f32], target: &[f32]) -> (f32, f32) {
        let (mut sum, mut towards) = (0.0, 0.0);
        let mut add = |at: usize, bond: f32| {
            let weight = series(certainty[at], bond);
            sum += weight;
            towards += weight * target[at];
        };
        let at = y * self.width + x;
        add(at, f32::INFINITY);
        let right = (x + 1 < self.width).then(|| self.along_rows[at]);
        let below = (y + 1 < height).then(|| self.along_columns[x * height + y]);
        if let Some(bond) = right {
            add(at + 1, bond);
        }
        if let Some(bond) = below {
            add(at + self.width, bond);
        }
        if let (Some(right), Some(below)) = (right, below) {
            let around = series(right, self.along_columns[(x + 1) * height + y]);
            add(at + self.width + 1, around + series(below, self.along_rows[at + self.width]));
        }
        (sum, if sum > 0.0 { towards / sum } else { target[at] })
    }

    /// The bonds of every second pixel of every second line.
    fn halved(&self, height: usize) -> Self {
        let columns = self.width.div_ceil(2);
        Self {
            width: columns,
            along_rows: every_second(&self.along_rows, self.width),
            along_columns: every_second(&self.along_columns, height),
        }
    }

    /// Does `rounds` rounds toward the minimum of Σ certainty (value − target)² + Σ bond (value − neighbour)².
    pub fn relax(&self, values: &mut Vec<f32>, certainty: &[f32], target: &[f32], rounds: usize) {
        let (width, height) = (self.width, values.len() / self.width);
        let rows =
            Side { length: width, along: &self.along_rows, across: transposed(&self.along_columns, height) };
        let columns =
            Side { length: height, along: &self.along_columns, across: transposed(&self.along_rows, width) };
        let turned = [transposed(certainty, width), transposed(target, width)];
        for _ in 0..rounds {
            rows.relax(values, certainty, target);
            *values = transposed(values, width);
            columns.relax(values, &turned[0], &turned[1]);
            *values = transposed(values, height);
        }
    }
}

/// Two bonds in series.
fn series(a: f32, b: f32) -> f32 {
    if b.is_infinite() {
        a
    } else if a + b > 0.0 {
        a * b / (a + b)
    } else {
        0.0
    }
}

/// Bonds along every second line of `length` between every second pixel; each represents two lines.
fn every_second(along: &[f32], length: usize) -> Vec<f32> {
    let lines = along.chunks(length).step_by(2);
    let bond = |pair: &[f32]| if let [a, b] = *pair { 2.0 * series(a, b) } else { 0.0 };
    lines.flat_map(|line| line.chunks(2).map(bond)).collect()
}

/// The rows of a picture, or of the transposed one.
struct Side<'a> {
    length: usize,
    along: &'a [f32],
    /// Bonds with the next line, laid out as the lines are.
    across: Vec<f32>,
}

impl Side<'_> {
    /// Solves every second line exactly with the others as they are, then those.
    fn relax(&self, values: &mut [f32], certainty: &[f32], target: &[f32]) {
        let n = self.length;
        for parity in 0..2 {
            let old = values.to_vec();
            let lines = values.par_chunks_mut(n).enumerate().filter(|(line, _)| line % 2 == parity);
            lines.for_each(|(line, values)| {
                let mut walk = Walk::new(n);
                for i in 0..n {
                    let at = line * n + i;
                    let before = if i > 0 { self.along[at - 1] } else { 0.0 };
                    let (mut own, mut towards) = (certainty[at], certainty[at] * target[at]);
                    if line > 0 {
                        own += self.across[at - n];
                        towards += self.across[at - n] * old[at - n];
                    }
                    if at + n < old.len() {
                        own += self.across[at];
                        towards += self.across[at] * old[at + n];
                    }
                    walk.step(before, self.along[at], own, towards);
                }
                walk.back(values);
            });
        }
    }
}

/// The forward pass: the value of `i` is `ahead[i]` + `pull[i]` · the next value.
struct Walk {
    pull: Vec<f32>,
    ahead: Vec<f32>,
    /// 1 − pull of the last, stored by itself: where certainties are tiny the difference would cancel.
    slack: f32,
}

impl Walk {
    fn new(length: usize) -> Self {
        Self { pull: Vec::with_capacity(length), ahead: Vec::with_capacity(length), slack: 0.0 }
    }

    /// One step: eliminates the previous value.
    fn step(&mut self, before: f32, after: f32, own: f32, towards: f32) {
        let last = self.ahead.last().copied().unwrap_or(0.0);
        let own = own + before * self.slack;
        let pivot = own + after;
        // No certainty here or before, and no bond: any value will do.
        let inverse = if pivot > 0.0 { 1.0 / pivot } else { 0.0 };
        self.pull.push(after * inverse);
        self.ahead.push((towards + before * last) * inverse);
        self.slack = own * inverse;
    }

    /// The backward pass.
    fn back(&self, values: &mut [f32]) {
        let mut next = 0.0;
        for (value, (pull, ahead)) in values.iter_mut().zip(self.pull.iter().zip(&self.ahead)).rev() {
            next = ahead + pull * next;
            *value = next;
        }
    }
}

/// Columns as rows.
fn transposed(values: &[f32], length: usize) -> Vec<f32> {
    let lines = values.len() / length;
    let mut turned = vec![0.0; values.len()];
    turned.par_chunks_mut(lines).enumerate().for_each(|(i, column)| {
        column.iter_mut().enumerate().for_each(|(line, value)| *value = values[line * length + i]);
    });
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_fixed_at_two_sides_ramp_between() {
        let (width, height) = (6, 5);
        let bonds = Bonds::new(width, height, |_, _| 1.0);
        let is_fixed = |i: usize| [0, width - 1].contains(&(i % width));
        let certainty: Vec<f32> = (0..width * height).map(|i| if is_fixed(i) { 1e6 } else { 1e-9 }).collect();
        let target: Vec<f32> =
            (0..width * height).map(|i| (i % width) as f32 / 5.0 * f32::from(is_fixed(i))).collect();
        let mut values = vec![0.0; width * height];
        bonds.relax(&mut values, &certainty, &target, 60);
        for (i, value) in values.iter().enumerate() {
            assert!((value - (i % width) as f32 / 5.0).abs() < 1e-3, "{i}: {value}");
        }
    }

    #[test]
    fn what_is_hardly_certain_is_still_a_number() {
        // One pixel is certain, bonds of all sizes: a cancelling difference would be divided by.
        let (width, height) = (40, 3);
        let bonds = Bonds::new(width, height, |a, b| if (a + b) % 3 == 0 { 1e-12 } else { 1e4 });
        let certainty: Vec<f32> = (0..width * height).map(|i| f32::from(i == 7)).collect();
        let mut values = vec![2.0; width * height];
        bonds.relax(&mut values, &certainty, &vec![2.0; width * height], 20);
        assert!(values.iter().all(|v| (v - 2.0).abs() < 1e-3), "{values:?}");
    }

    #[test]
    fn what_is_far_away_settles_a_plain_surface_and_a_line_before_it_stays() {
        // A plain picture of which one side is certain, and before it a line two pixels wide that is certain to be
        // nearer.
        let (width, height) = (150, 90);
        let line = |i: usize| (70..72).contains(&(i % width)) && i / width >= 60;
        let bonds = Bonds::new(width, height, |a, b| if line(a) == line(b) { 1.0 } else { 1e-6 });
        let target: Vec<f32> = (0..width * height).map(|i| f32::from(line(i))).collect();
        let certainty: Vec<f32> = (0..width * height).map(|i| f32::from(line(i) || i % width == 0)).collect();
        let mut values = vec![0.7; width * height];
        bonds.solve_coarse_to_fine(&mut values, &certainty, &target, 24);
        for (i, value) in values.iter().enumerate() {
            assert!((value - f32::from(line(i))).abs() < 0.3, "{}, {}: {value}", i % width, i / width);
        }
    }
}
