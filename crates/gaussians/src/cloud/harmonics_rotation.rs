//! Spherical harmonics of a cloud that is turned: its coefficients in other axes.
//!
//! A splat that sends c(D) = Σ Yⱼ(D) kⱼ sends c′(D) = c(Rᵀ D) when it is turned by R. Within a degree the harmonics span the same functions in
//! all axes, so that
//!
//! ```text
//! k′ⱼ = Σᵢ Mⱼᵢ kᵢ,   Mⱼᵢ = ∫ Yⱼ(D) Yᵢ(Rᵀ D) dD
//! ```
//!
//! (Wigner's matrices, real). The integrand is a polynomial of at most degree 8, for which the sum over 5 × 9 directions is exact: Gauss and
//! Legendre's in z, equally spaced around it.

use super::harmonics::{MAX_COEFFICIENTS, coefficient_count, harmonics};
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

/// The nodes of Gauss and Legendre's rule of degree 9 in [−1, 1], and their weights.
const HEIGHTS: [(f64, f64); 5] = [
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// As many directions around the axis are exact for polynomials of degree 8.
const DIRECTIONS: usize = 9;

/// The matrices that turn coefficients.
pub struct HarmonicsRotation {
    degree: u32,
    /// M, of which only the square blocks of each degree are not 0.
    matrix: [[f64; MAX_COEFFICIENTS]; MAX_COEFFICIENTS],
}

impl HarmonicsRotation {
    /// Turns coefficients of degree 1 to `degree` by `rotation`, an orthogonal matrix.
    pub fn new(rotation: DMat3, degree: u32) -> Self {
        let mut matrix = [[0.0; MAX_COEFFICIENTS]; MAX_COEFFICIENTS];
        for (z, weight) in HEIGHTS {
            for k in 0..DIRECTIONS {
                let (sin, cos) = (TAU * k as f64 / DIRECTIONS as f64).sin_cos();
                let direction = DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z);
                let after = harmonics(direction.as_vec3(), degree).map(f64::from);
                let before = harmonics((rotation.transpose() * direction).as_vec3(), degree);
                for (row, y) in matrix.iter_mut().zip(after) {
                    let share = weight * TAU / DIRECTIONS as f64 * y;
                    row.iter_mut().zip(before).for_each(|(m, y)| *m += share * f64::from(y));
                }
            }
        }
        Self { degree, matrix }
    }

    /// Turns the coefficients of one splat: coefficient by coefficient, red, green and blue of each beside each other.
    ///
    /// # Panics
    /// They are not those of the degree.
    pub fn apply(&self, coefficients: &mut [f32]) {
        assert_eq!(coefficients.len(), 3 * coefficient_count(self.degree));
        for degree in 1..=self.degree {
            let band = coefficient_count(degree - 1)..coefficient_count(degree);
            let mut before = [[0.0; 3]; 9];
            for (before, rgb) in before.iter_mut().zip(coefficients[3 * band.start..].chunks_exact(3)) {
                *before = [rgb[0], rgb[1], rgb[2]].map(f64::from);
            }
            for j in band.clone() {
                for channel in 0..3 {
                    let terms = band.clone().zip(&before).map(|(i, rgb)| self.matrix[j][i] * rgb[channel]);
                    coefficients[3 * j + channel] = terms.sum::<f64>() as f32;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn a_turned_splat_looks_as_it_did_from_the_turned_side() {
        let turn = DMat3::from_quat(DQuat::from_xyzw(0.3, -0.5, 0.2, 0.7).normalize());
        let mirror = turn * DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0));
        for (degree, rotation) in [(1, turn), (2, turn), (3, turn), (4, turn), (4, mirror)] {
            let count = coefficient_count(degree);
            let original: Vec<f32> = (0..3 * count).map(|k| ((k * 37 % 17) as f32 - 8.0) / 8.0).collect();
            let mut turned = original.clone();
            HarmonicsRotation::new(rotation, degree).apply(&mut turned);
            let color = |coefficients: &[f32], direction: DVec3| {
                let basis = harmonics(direction.as_vec3(), degree);
                [0, 1, 2].map(|c| (0..count).map(|k| basis[k] * coefficients[3 * k + c]).sum::<f32>())
            };
            let mut greatest_change = 0.0f32;
            for k in 0..50 {
                let direction = DVec3::new((k as f64).sin(), (2.3 * k as f64).cos(), (0.7 * k as f64).sin());
                let direction = direction.normalize();
                let (expected, found) = (color(&original, direction), color(&turned, rotation * direction));
                let unturned = color(&original, rotation * direction);
                for channel in 0..3 {
                    let error = (expected[channel] - found[channel]).abs();
                    assert!(error < 1e-4, "degree {degree}, channel {channel}: {error}");
                    greatest_change = greatest_change.max((expected[channel] - unturned[channel]).abs());
                }
            }
            assert!(greatest_change > 0.1, "unturned coefficients would pass");
        }
    }
}
