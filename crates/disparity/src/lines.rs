//! A picture of values that hang together: weighted least squares on the grid of pixels, line by line.
//!
//! A row whose neighbours above and below are known is a tridiagonal system: solved exactly in one walk there and back. Rows and
//! columns in turn carry what is known across plain surfaces in a few rounds (line relaxation; Min et al., *Fast Global Image
//! Smoothing Based on Weighted Least Squares*, TIP 2014, section III for lines). Columns are rows of the transposed picture.

use rayon::prelude::*;

/// How much neighbours hang together.
pub struct Bonds {
    width: usize,
    /// Of each pixel and the one to its right, row by row; 0 in the last column.
    along_rows: Vec<f32>,
    /// Of each pixel and the one below, column by column; 0 in the last row.
    along_columns: Vec<f32>,
}

impl Bonds {
    /// The bonds that `of` tells for pairs of indices.
    pub fn new(width: usize, height: usize, of: impl Fn(usize, usize) -> f32 + Sync) -> Self {
        let mut along_rows = vec![0.0; width * height];
        along_rows.par_chunks_mut(width).enumerate().for_each(|(y, bonds)| {
            for (x, bond) in bonds[..width - 1].iter_mut().enumerate() {
                *bond = of(y * width + x, y * width + x + 1);
            }
        });
        let mut along_columns = vec![0.0; width * height];
        along_columns.par_chunks_mut(height).enumerate().for_each(|(x, bonds)| {
            for (y, bond) in bonds[..height - 1].iter_mut().enumerate() {
                *bond = of(y * width + x, (y + 1) * width + x);
            }
        });
        Self { width, along_rows, along_columns }
    }

    /// Smooths values over about √`strength` pixels where bonds are 1.
    pub fn smooth(&self, values: &mut Vec<f32>, strength: f32) {
        let height = values.len() / self.width;
        // Weaker from round to round, so that the last one leaves no streaks: Min et al., equation 13.
        for round in 0..3 {
            let strength = 1.5 * 4f32.powi(2 - round) / 63.0 * strength;
            let rounds = [(self.width, &self.along_rows), (height, &self.along_columns)];
            for (length, bonds) in rounds {
                values.par_chunks_mut(length).zip(bonds.par_chunks(length)).for_each(|(values, bonds)| {
                    let mut walk = Walk::new(length);
                    for i in 0..length {
                        let before = if i > 0 { strength * bonds[i - 1] } else { 0.0 };
                        walk.step(before, strength * bonds[i], 1.0, values[i]);
                    }
                    walk.back(values);
                });
                *values = transposed(values, length);
            }
        }
    }

    /// Goes `rounds` rounds towards the minimum of Σ certainty (value − target)² + Σ bond (value − neighbour)².
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

/// What the walk there leaves behind: the value of `i` is `ahead` + `pull` · the value of the next.
struct Walk {
    pull: Vec<f32>,
    ahead: Vec<f32>,
    /// 1 − pull of the last, kept by itself: where almost nothing is known the difference would be lost.
    slack: f32,
}

impl Walk {
    fn new(length: usize) -> Self {
        Self { pull: Vec::with_capacity(length), ahead: Vec::with_capacity(length), slack: 0.0 }
    }

    /// One step: eliminates what stands before.
    fn step(&mut self, before: f32, after: f32, own: f32, towards: f32) {
        let last = self.ahead.last().copied().unwrap_or(0.0);
        let own = own + before * self.slack;
        let pivot = own + after;
        // Nothing is known here or before, and nothing hangs together: any value will do.
        let inverse = if pivot > 0.0 { 1.0 / pivot } else { 0.0 };
        self.pull.push(after * inverse);
        self.ahead.push((towards + before * last) * inverse);
        self.slack = own * inverse;
    }

    /// The walk back.
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
    fn what_is_known_at_two_sides_is_a_ramp_between() {
        let (width, height) = (6, 5);
        let bonds = Bonds::new(width, height, |_, _| 1.0);
        let known = |i: usize| [0, width - 1].contains(&(i % width));
        let certainty: Vec<f32> = (0..width * height).map(|i| if known(i) { 1e6 } else { 1e-9 }).collect();
        let target: Vec<f32> =
            (0..width * height).map(|i| (i % width) as f32 / 5.0 * f32::from(known(i))).collect();
        let mut values = vec![0.0; width * height];
        bonds.relax(&mut values, &certainty, &target, 60);
        for (i, value) in values.iter().enumerate() {
            assert!((value - (i % width) as f32 / 5.0).abs() < 1e-3, "{i}: {value}");
        }
    }

    #[test]
    fn what_is_hardly_known_is_still_a_number() {
        // One pixel is known, bonds of all sizes: differences of nearly equal numbers would be divided by.
        let (width, height) = (40, 3);
        let bonds = Bonds::new(width, height, |a, b| if (a + b) % 3 == 0 { 1e-12 } else { 1e4 });
        let certainty: Vec<f32> = (0..width * height).map(|i| f32::from(i == 7)).collect();
        let mut values = vec![2.0; width * height];
        bonds.relax(&mut values, &certainty, &vec![2.0; width * height], 20);
        assert!(values.iter().all(|v| (v - 2.0).abs() < 1e-3), "{values:?}");
    }

    #[test]
    fn smoothing_keeps_a_constant_and_stops_where_there_is_no_bond() {
        let (width, height) = (12, 10);
        let bonds = Bonds::new(width, height, |a, b| f32::from(a % width != 5 || b % width != 6));
        let start: Vec<f32> = (0..width * height).map(|i| if i % width < 6 { 1.0 } else { 3.0 }).collect();
        let mut values = start.clone();
        bonds.smooth(&mut values, 500.0);
        assert!(values.iter().zip(&start).all(|(a, b)| (a - b).abs() < 1e-4));
        // With bonds throughout, the step is smoothed away.
        Bonds::new(width, height, |_, _| 1.0).smooth(&mut values, 500.0);
        assert!((values[5] - values[6]).abs() < 0.5);
    }
}
