//! Normal equations of the exposures.

use super::exposure_observations::ExposureObservation;
use numerics::upper_median;

/// Layout of the unknowns of the normal equations.
pub(super) struct NormalEquations<'a> {
    pub unknowns: usize,
    pub views: usize,
    pub lens_of: &'a [usize],
}

impl NormalEquations<'_> {
    /// Matrix, right-hand side and absolute residuals of some points, weighted by their residuals under a solution.
    pub fn accumulate(
        &self,
        points: &[Vec<ExposureObservation>],
        solution: &[f64],
        scale: f64,
    ) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let n = self.unknowns;
        let (mut matrix, mut right, mut errors) = (vec![0.0; n * n], vec![0.0; n], Vec::new());
        let mut mean_row = vec![0.0; n];
        for point in points {
            for channel in 0..3 {
                let row = |observation: &ExposureObservation| {
                    let lens = 3 * self.views + 2 * self.lens_of[observation.view];
                    let [k1, k2] = observation.vignetting;
                    [(3 * observation.view + channel, 1.0), (lens, k1), (lens + 1, k2)]
                };
                let residual = |observation: &ExposureObservation| {
                    let predicted: f64 =
                        row(observation).iter().map(|&(at, factor)| factor * solution[at]).sum();
                    observation.stops[channel] - predicted
                };
                // The point's own light: a median tolerates outliers of up to half of the observations.
                let mut all: Vec<f64> = point.iter().map(residual).collect();
                if all.len() < 2 {
                    continue;
                }
                let middle = upper_median(&mut all).unwrap_or(0.0);
                let (mut weights, mut mean) = (0.0, 0.0);
                let mut touched = Vec::with_capacity(point.len() * 3);
                for observation in point {
                    let error = residual(observation) - middle;
                    errors.push(error.abs());
                    let weight = observation.weight / (1.0 + (error / scale).powi(2));
                    weights += weight;
                    mean += weight * observation.stops[channel];
                    let row = row(observation);
                    for &(i, a) in &row {
                        right[i] += weight * a * observation.stops[channel];
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
