//! Directional variation of a texel's radiance, interpolated from the few photographed directions.
//!
//! Gaussian process regression (Rasmussen and Williams 2006, chapter 2) of the residual beside the constant part. Its
//! mean is zero, so it fades out where evidence ends, and it is smooth in direction, so nothing pops within an
//! aperture.
//!
//! ```text
//! r(ω) = Σᵢ αᵢ·k(|ω − ωᵢ|)        (K + N)·α = r        k(d) = (1 − d/ρ)⁴₊·(4d/ρ + 1)
//! ```
//!
//! | symbol | meaning | unit |
//! | --- | --- | --- |
//! | ω, ωᵢ | unit directions from the point to the eye and to photograph i | |
//! | r, rᵢ | radiance less the constant part | as the photographs |
//! | k | Wendland's C² function: positive definite in space, 0 from ρ on | |
//! | K | kᵢⱼ = k(\|ωᵢ − ωⱼ\|) | |
//! | N | noise over signal, λ/wᵢ on the diagonal, wᵢ the weight of photograph i | |
//!
//! The leave-one-out prediction of each photograph has a closed form: rᵢ − αᵢ/((K + N)⁻¹)ᵢᵢ (the same, equation 5.12).
//! It selects ρ and λ, and the confidence in r by region.

use glam::{DVec3, Vec3};

/// Maximum number of photographs used for a texel; of more, those with the largest weights.
pub(crate) const MAX_PHOTOGRAPHS: usize = 40;

/// Covariance of residuals by direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kernel {
    /// ρ: distance between unit directions from which on residuals are independent.
    pub reach: f32,
    /// λ: noise over signal.
    pub noise: f32,
}

/// Residual of a texel in one photograph.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ResidualSample {
    /// Index among the texel's observations.
    pub index: usize,
    /// Unit direction from the texel to the camera.
    pub direction: Vec3,
    pub value: Vec3,
    /// Weight, in (0, 1].
    pub weight: f32,
}

/// Scratch space for the regression of a texel.
pub(crate) struct Regression {
    matrix: Vec<f32>,
    inverse: Vec<f32>,
}

impl Kernel {
    /// The kernel's value, in [0, 1], at a distance between unit directions; 0 from its reach on (Wendland's C²
    /// function).
    pub fn at(&self, distance: f32) -> f32 {
        let share = distance / self.reach;
        if share >= 1.0 {
            return 0.0;
        }
        let rest = (1.0 - share) * (1.0 - share);
        rest * rest * (4.0 * share + 1.0)
    }

    /// k between the direction of `toward`, which may have any length, and a unit `direction`: |u − v|² = 2 − 2·u·v.
    pub fn between_directions(&self, toward: Vec3, direction: Vec3) -> f32 {
        let (dot, square) = (toward.dot(direction), toward.length_squared());
        // u·v at which |u − v| is the reach. x·|x| increases with x, so directions out of reach are detected without a
        // square root.
        let min_cosine = 1.0 - 0.5 * self.reach * self.reach;
        if dot * dot.abs() <= min_cosine * min_cosine.abs() * square {
            return 0.0;
        }
        self.at((2.0 - 2.0 * dot / square.sqrt()).max(0.0).sqrt())
    }
}

impl Regression {
    /// Room for the regression of up to [`MAX_PHOTOGRAPHS`] residuals.
    pub fn new() -> Self {
        Self {
            matrix: vec![0.0; MAX_PHOTOGRAPHS * MAX_PHOTOGRAPHS],
            inverse: vec![0.0; MAX_PHOTOGRAPHS * MAX_PHOTOGRAPHS],
        }
    }

    /// Cholesky decomposition of K + N (lower triangle) for the directions and weights of at most [`MAX_PHOTOGRAPHS`]
    /// residuals.
    pub fn decompose(&mut self, kernel: &Kernel, residuals: &[ResidualSample]) {
        for (i, a) in residuals.iter().enumerate() {
            let (above, rows) = self.matrix.split_at_mut(i * MAX_PHOTOGRAPHS);
            for (j, b) in residuals[..i].iter().enumerate() {
                let other = &above[j * MAX_PHOTOGRAPHS..j * MAX_PHOTOGRAPHS + j + 1];
                let sum = dot(&rows[..j], &other[..j]);
                rows[j] = (kernel.at(a.direction.distance(b.direction)) - sum) / other[j];
            }
            let square = dot(&rows[..i], &rows[..i]);
            // Noise keeps it positive; rounding costs about 1e-6 of 1.
            rows[i] = (1.0 + kernel.noise / a.weight - square).max(1e-5).sqrt();
        }
    }

    /// Solves for α, after [`Self::decompose`] for the same directions and weights.
    pub fn solve(&self, residuals: &[ResidualSample], alpha: &mut Vec<Vec3>) {
        let n = residuals.len();
        alpha.clear();
        alpha.extend(residuals.iter().map(|k| k.value));
        for i in 0..n {
            for k in 0..i {
                let before = alpha[k];
                alpha[i] -= before * self.matrix[i * MAX_PHOTOGRAPHS + k];
            }
            alpha[i] /= self.matrix[i * MAX_PHOTOGRAPHS + i];
        }
        for i in (0..n).rev() {
            for k in i + 1..n {
                let after = alpha[k];
                alpha[i] -= after * self.matrix[k * MAX_PHOTOGRAPHS + i];
            }
            alpha[i] /= self.matrix[i * MAX_PHOTOGRAPHS + i];
        }
    }

    /// Leave-one-out predictions of the residuals, into `predictions`; after [`Self::solve`] for the same residuals.
    pub fn leave_one_out(
        &mut self,
        residuals: &[ResidualSample],
        alpha: &[Vec3],
        predictions: &mut Vec<Vec3>,
    ) {
        let n = residuals.len();
        // Inverse of the triangle; its columns give the diagonal of the full inverse.
        for j in 0..n {
            self.inverse[j * MAX_PHOTOGRAPHS + j] = 1.0 / self.matrix[j * MAX_PHOTOGRAPHS + j];
            for i in j + 1..n {
                let sum: f32 = (j..i)
                    .map(|k| self.matrix[i * MAX_PHOTOGRAPHS + k] * self.inverse[k * MAX_PHOTOGRAPHS + j])
                    .sum();
                self.inverse[i * MAX_PHOTOGRAPHS + j] = -sum / self.matrix[i * MAX_PHOTOGRAPHS + i];
            }
        }
        predictions.clear();
        predictions.extend((0..n).map(|j| {
            let diagonal: f32 = (j..n).map(|i| self.inverse[i * MAX_PHOTOGRAPHS + j].powi(2)).sum();
            residuals[j].value - alpha[j] / diagonal
        }));
    }
}

/// Σ aₖ·bₖ of lists of equal length, in eight independent sums for SIMD.
#[inline]
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f32 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f32>() + rest
}

/// Unit direction from a texel to an eye.
pub(crate) fn direction_to_eye(from: DVec3, eye: DVec3) -> Vec3 {
    (eye - from).as_vec3().normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kernel_between_directions_is_that_at_their_distance() {
        let direction = Vec3::new(0.36, -0.48, 0.8);
        let aside = Vec3::new(0.8, 0.6, 0.0);
        for reach in [0.6, 1.0, 1.6] {
            let kernel = Kernel { reach, noise: 0.1 };
            for angle in (0..=180).map(|degree| (degree as f32).to_radians()) {
                let unit = direction * angle.cos() + aside * angle.sin();
                for length in [1e-3, 1.0, 40.0] {
                    let (value, expected) = (
                        kernel.between_directions(unit * length, direction),
                        kernel.at(unit.distance(direction)),
                    );
                    assert!((value - expected).abs() < 1e-5, "{reach} {angle}: {value}, {expected}");
                }
            }
        }
        assert_eq!(Kernel { reach: 1.6, noise: 0.1 }.between_directions(Vec3::ZERO, direction), 0.0);
    }

    fn test_residuals(count: usize) -> Vec<ResidualSample> {
        (0..count)
            .map(|k| {
                let azimuth = k as f32 * 2.4;
                let z = 1.0 - 0.6 * (k as f32 + 0.5) / count as f32;
                let r = (1.0 - z * z).sqrt();
                let direction = Vec3::new(r * azimuth.cos(), r * azimuth.sin(), z);
                ResidualSample {
                    index: k,
                    direction,
                    value: Vec3::new(direction.x, direction.y.powi(2), 0.1),
                    weight: 1.0,
                }
            })
            .collect()
    }

    fn at(kernel: &Kernel, residuals: &[ResidualSample], alpha: &[Vec3], direction: Vec3) -> Vec3 {
        residuals.iter().zip(alpha).map(|(k, a)| *a * kernel.at(k.direction.distance(direction))).sum()
    }

    #[test]
    fn leave_one_out_is_the_prediction_of_the_others() {
        let (kernel, all) = (Kernel { reach: 1.2, noise: 0.1 }, test_residuals(12));
        let (mut regression, mut alpha, mut predictions) = (Regression::new(), Vec::new(), Vec::new());
        regression.decompose(&kernel, &all);
        regression.solve(&all, &mut alpha);
        regression.leave_one_out(&all, &alpha, &mut predictions);
        for (left, predicted) in predictions.iter().enumerate() {
            let mut others = all.clone();
            let out = others.remove(left);
            let mut of_others = Vec::new();
            regression.decompose(&kernel, &others);
            regression.solve(&others, &mut of_others);
            let expected = at(&kernel, &others, &of_others, out.direction);
            assert!(predicted.distance(expected) < 1e-4, "{left}: {predicted} for {expected}");
        }
    }

    #[test]
    fn little_noise_interpolates_the_data_and_the_kernel_has_compact_support() {
        let (kernel, all) = (Kernel { reach: 0.5, noise: 1e-3 }, test_residuals(12));
        let (mut regression, mut alpha) = (Regression::new(), Vec::new());
        regression.decompose(&kernel, &all);
        regression.solve(&all, &mut alpha);
        for sample in &all {
            assert!(at(&kernel, &all, &alpha, sample.direction).distance(sample.value) < 0.02);
        }
        assert_eq!(at(&kernel, &all, &alpha, Vec3::NEG_Z), Vec3::ZERO);
    }
}
