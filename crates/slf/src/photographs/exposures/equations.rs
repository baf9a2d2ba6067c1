//! The normal equations of exposures.

use super::said::Said;
use crate::photographs::numbers::median;

/// The normal equations.
pub(super) struct System<'a> {
    pub unknowns: usize,
    pub views: usize,
    pub lens_of: &'a [usize],
}

impl System<'_> {
    /// Matrix, right side and absolute residuals of some points, weighted by how a solution explains them.
    pub fn of_points(
        &self,
        points: &[Vec<Said>],
        solution: &[f64],
        scale: f64,
    ) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let n = self.unknowns;
        let (mut matrix, mut right, mut errors) = (vec![0.0; n * n], vec![0.0; n], Vec::new());
        let mut mean_row = vec![0.0; n];
        for point in points {
            for channel in 0..3 {
                let row = |said: &Said| {
                    let lens = 3 * self.views + 2 * self.lens_of[said.view];
                    let [k1, k2] = said.vignetting;
                    [(3 * said.view + channel, 1.0), (lens, k1), (lens + 1, k2)]
                };
                let off = |said: &Said| {
                    let told: f64 = row(said).iter().map(|&(at, factor)| factor * solution[at]).sum();
                    said.stops[channel] - told
                };
                // The point's own light, as most say: a median holds out where half of them are wrong.
                let mut all: Vec<f64> = point.iter().map(off).collect();
                if all.len() < 2 {
                    continue;
                }
                let middle = median(&mut all, f64::total_cmp).unwrap_or(0.0);
                let (mut weights, mut mean) = (0.0, 0.0);
                let mut touched = Vec::with_capacity(point.len() * 3);
                for said in point {
                    let error = off(said) - middle;
                    errors.push(error.abs());
                    let weight = said.weight / (1.0 + (error / scale).powi(2));
                    weights += weight;
                    mean += weight * said.stops[channel];
                    let row = row(said);
                    for &(i, a) in &row {
                        right[i] += weight * a * said.stops[channel];
                        for &(j, b) in &row {
                            matrix[i * n + j] += weight * a * b;
                        }
                        mean_row[i] += weight * a;
                        touched.push(i);
                    }
                }
                touched.sort_unstable();
                touched.dedup();
                if weights > 0.0 {
                    for &i in &touched {
                        right[i] -= mean_row[i] * mean / weights;
                        for &j in &touched {
                            matrix[i * n + j] -= mean_row[i] * mean_row[j] / weights;
                        }
                    }
                }
                for &i in &touched {
                    mean_row[i] = 0.0;
                }
            }
        }
        (matrix, right, errors)
    }
}
