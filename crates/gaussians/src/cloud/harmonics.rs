//! Real spherical harmonics: how a splat's colour depends on the direction from which it is viewed.
//!
//! ```text
//! c(D) = max(0, ½ + Y₀·dc + Σₗₘ Yₗₘ(D) kₗₘ)
//! ```
//!
//! D is the unit vector from the eye to the mean, in the axes of the file. Signs and factors are those of Kerbl et al. 2023 (with the
//! Condon–Shortley phase), degree 4 as gsplat continues them.

use glam::Vec3;

/// The highest degree that a file may have.
pub const MAX_DEGREE: u32 = 4;

/// Coefficients of degree 1 to [`MAX_DEGREE`], for each colour channel.
pub const MAX_COEFFICIENTS: usize = coefficient_count(MAX_DEGREE);

/// Y₀, the harmonic of degree 0.
pub const BASE: f32 = 0.282_094_8;

/// The number of coefficients of degree 1 to `degree`, for each colour channel: (degree + 1)² − 1.
pub const fn coefficient_count(degree: u32) -> usize {
    let side = degree as usize + 1;
    side * side - 1
}

/// The degree that has this number of coefficients (for each colour channel, degree 0 not counted); `None` if none has.
pub fn degree_of(coefficients: usize) -> Option<u32> {
    (0..=MAX_DEGREE).find(|degree| coefficient_count(*degree) == coefficients)
}

/// The harmonics of degree 1 to `degree` toward the unit vector `direction`, from the lowest order of the lowest degree on; those of
/// higher degrees are 0.
#[rustfmt::skip]
pub fn harmonics(direction: Vec3, degree: u32) -> [f32; MAX_COEFFICIENTS] {
    let mut basis = [0.0; MAX_COEFFICIENTS];
    let Vec3 { x, y, z } = direction;
    if degree >= 1 {
        basis[0] = -0.488_602_5 * y;
        basis[1] = 0.488_602_5 * z;
        basis[2] = -0.488_602_5 * x;
    }
    let (xx, yy, zz) = (x * x, y * y, z * z);
    if degree >= 2 {
        basis[3] = 1.092_548_5 * x * y;
        basis[4] = -1.092_548_5 * y * z;
        basis[5] = 0.315_391_57 * (2.0 * zz - xx - yy);
        basis[6] = -1.092_548_5 * x * z;
        basis[7] = 0.546_274_24 * (xx - yy);
    }
    if degree >= 3 {
        basis[8] = -0.590_043_6 * y * (3.0 * xx - yy);
        basis[9] = 2.890_611_4 * x * y * z;
        basis[10] = -0.457_045_8 * y * (4.0 * zz - xx - yy);
        basis[11] = 0.373_176_34 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy);
        basis[12] = -0.457_045_8 * x * (4.0 * zz - xx - yy);
        basis[13] = 1.445_305_7 * z * (xx - yy);
        basis[14] = -0.590_043_6 * x * (xx - 3.0 * yy);
    }
    if degree >= 4 {
        basis[15] = 2.503_343 * x * y * (xx - yy);
        basis[16] = -1.770_130_8 * y * z * (3.0 * xx - yy);
        basis[17] = 0.946_174_7 * x * y * (7.0 * zz - 1.0);
        basis[18] = -0.669_046_5 * y * z * (7.0 * zz - 3.0);
        basis[19] = 0.105_785_55 * (zz * (35.0 * zz - 30.0) + 3.0);
        basis[20] = -0.669_046_5 * x * z * (7.0 * zz - 3.0);
        basis[21] = 0.473_087_35 * (xx - yy) * (7.0 * zz - 1.0);
        basis[22] = -1.770_130_8 * x * z * (xx - 3.0 * yy);
        basis[23] = 0.625_835_7 * (xx * (xx - 3.0 * yy) - yy * (3.0 * xx - yy));
    }
    basis
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over the sphere the harmonics are orthonormal: ∫ Yₐ Yᵦ = δ. Any wrong factor, sign pattern or power breaks it.
    #[test]
    fn harmonics_are_orthonormal() {
        const STEPS: usize = 48;
        let mut product = [[0.0f64; MAX_COEFFICIENTS]; MAX_COEFFICIENTS];
        let mut mean = [0.0f64; MAX_COEFFICIENTS];
        for i in 0..STEPS {
            for k in 0..STEPS {
                let z = -1.0 + 2.0 * (i as f64 + 0.5) / STEPS as f64;
                let angle = std::f64::consts::TAU * k as f64 / STEPS as f64;
                let r = (1.0 - z * z).sqrt();
                let direction = Vec3::new((r * angle.cos()) as f32, (r * angle.sin()) as f32, z as f32);
                let basis = harmonics(direction, MAX_DEGREE).map(f64::from);
                let weight = 4.0 * std::f64::consts::PI / (STEPS * STEPS) as f64;
                for a in 0..MAX_COEFFICIENTS {
                    mean[a] += weight * basis[a];
                    for (sum, y) in product[a].iter_mut().zip(basis) {
                        *sum += weight * basis[a] * y;
                    }
                }
            }
        }
        for (a, (mean, products)) in mean.iter().zip(&product).enumerate() {
            assert!(mean.abs() < 0.01, "{a}: {mean}");
            for (b, product) in products.iter().enumerate() {
                let expected = f64::from(u8::from(a == b));
                assert!((product - expected).abs() < 0.02, "{a} {b}: {product}");
            }
        }
    }

    #[test]
    fn degrees_and_counts_invert() {
        for (degree, count) in [0, 3, 8, 15, 24].into_iter().enumerate() {
            assert_eq!(coefficient_count(degree as u32), count);
            assert_eq!(degree_of(count), Some(degree as u32));
        }
        assert_eq!(degree_of(4), None);
        assert!(harmonics(Vec3::X, 1)[3..].iter().all(|&y| y == 0.0));
    }
}
