//! Ideal lens projections from directions to the plane of the picture.

use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// From a direction (X, Y, Z) in camera space (x right, y up, z forward) to a point of the plane (x right, y *down*), with ρ = |(X, Y)|.
/// Where no source is given, the formula is that of COLMAP's `sensor/models.h`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// (X, −Y)/Z: a pinhole. Z > 0 alone.
    Perspective,
    /// θ·(X, −Y)/ρ, tan θ = ρ/Z: an equidistant fisheye. All directions but straight back.
    Equidistant,
    /// atan(2r·tan(ω/2))/ω·(X, −Y)/ρ, r = ρ/Z (Devernay and Faugeras 2001). Z > 0 alone.
    FieldOfView {
        /// ω, rad, in [0, π).
        omega: f64,
    },
    /// 2(X, −Y)/(Z + √(Z² − 4kρ²)): its inverse is q ↦ q/(1 + k|q|²) (Fitzgibbon 2001).
    Division {
        /// k.
        k: f64,
    },
    /// (X, −Y)/(α√(βρ² + Z²) + (1 − α)Z) (Khomutenko et al. 2016).
    EnhancedUnified {
        /// α, in [0, 1].
        alpha: f64,
        /// β, > 0.
        beta: f64,
    },
    /// The q whose q(1 + r|q|²) is (X, −Y)/Z: distortion as VisualSFM has it, from measured to ideal. Z > 0 alone.
    MeasuredRadial {
        /// r.
        r: f64,
    },
    /// (longitude, −latitude), both 0 straight ahead: a panorama.
    Equirectangular,
}

impl Projection {
    /// The point of a direction of any length; `None` outside the projection's domain.
    pub fn plane_from_direction(&self, direction: DVec3) -> Option<DVec2> {
        let DVec3 { x, y, z } = direction;
        let across = DVec2::new(x, -y);
        let rho = across.length();
        let point = match *self {
            Self::Perspective => (z > 0.0).then(|| across / z)?,
            Self::Equidistant => match rho > 0.0 {
                true => across * (rho.atan2(z) / rho),
                false => (z > 0.0).then_some(DVec2::ZERO)?,
            },
            Self::FieldOfView { omega } => {
                let r = (z > 0.0).then(|| rho / z)?;
                let factor = match omega > 0.0 && r > 0.0 {
                    true => (2.0 * r * (0.5 * omega).tan()).atan() / (omega * r),
                    false => field_of_view_scale(omega),
                };
                across / z * factor
            }
            Self::Division { k } => {
                let root = z * z - 4.0 * k * rho * rho;
                let denominator = z + (root >= 0.0).then(|| root.sqrt())?;
                (denominator > 0.0).then(|| across * (2.0 / denominator))?
            }
            Self::EnhancedUnified { alpha, beta } => {
                let d = (beta * rho * rho + z * z).sqrt();
                // Beyond, two directions have one point.
                let bound = if alpha <= 0.5 { alpha / (1.0 - alpha) } else { (1.0 - alpha) / alpha };
                (z > -bound * d).then(|| across / (alpha * d + (1.0 - alpha) * z))?
            }
            Self::MeasuredRadial { r } => {
                let ideal = (z > 0.0).then(|| rho / z)?;
                if ideal > 0.0 { across / rho * measured_radius(r, ideal)? } else { DVec2::ZERO }
            }
            Self::Equirectangular => {
                (rho > 0.0 || z != 0.0).then(|| DVec2::new(x.atan2(z), -y.atan2(x.hypot(z))))?
            }
        };
        point.is_finite().then_some(point)
    }

    /// The unit direction of a point. Inverse of [`Self::plane_from_direction`]; `None` for a point that no direction
    /// is projected to.
    pub fn direction_from_plane(&self, point: DVec2) -> Option<DVec3> {
        let r2 = point.length_squared();
        let r = r2.sqrt();
        let ahead = |across: DVec2, z: f64| DVec3::new(across.x, -across.y, z);
        let direction = match *self {
            Self::Perspective => ahead(point, 1.0),
            Self::Equidistant => {
                let factor = if r > 0.0 { r.sin() / r } else { 1.0 };
                (r < PI).then(|| ahead(point * factor, r.cos()))?
            }
            Self::FieldOfView { omega } => {
                let angle = r * omega;
                let factor = match angle > 0.0 {
                    true => (angle < FRAC_PI_2).then(|| angle.tan() / (2.0 * r * (0.5 * omega).tan()))?,
                    false => 1.0 / field_of_view_scale(omega),
                };
                ahead(point * factor, 1.0)
            }
            // k > 0: each point within |q| = 1/√k has a twin beyond.
            Self::Division { k } => (k * r2 < 1.0).then(|| ahead(point, 1.0 + k * r2))?,
            Self::EnhancedUnified { alpha, beta } => {
                let root = 1.0 - (2.0 * alpha - 1.0) * beta * r2;
                let denominator = alpha * (root >= 0.0).then(|| root.sqrt())? + 1.0 - alpha;
                (denominator > 0.0).then(|| ahead(point, (1.0 - alpha * alpha * beta * r2) / denominator))?
            }
            Self::MeasuredRadial { r } => {
                // Where it stops rising, two points have one direction.
                (1.0 + 3.0 * r * r2 > 0.0).then(|| ahead(point * (1.0 + r * r2), 1.0))?
            }
            Self::Equirectangular => {
                let (longitude, latitude) = (point.x, -point.y);
                let (sin, cos) = longitude.sin_cos();
                let is_there = longitude.abs() <= PI && latitude.abs() <= FRAC_PI_2;
                is_there.then(|| DVec3::new(latitude.cos() * sin, latitude.sin(), latitude.cos() * cos))?
            }
        };
        direction.try_normalize()
    }
}

/// The limit of atan(2r·tan(ω/2))/(ωr) as r goes to 0.
fn field_of_view_scale(omega: f64) -> f64 {
    if omega > 0.0 { 2.0 * (0.5 * omega).tan() / omega } else { 1.0 }
}

/// The smallest q ≥ 0 of q(1 + rq²) = `ideal`: Newton's method within the bounds of a bisection.
fn measured_radius(r: f64, ideal: f64) -> Option<f64> {
    let fold = if r < 0.0 { (-1.0 / (3.0 * r)).sqrt() } else { f64::INFINITY };
    let [mut low, mut high] = [0.0, if r < 0.0 { fold } else { ideal }];
    if high * (1.0 + r * high * high) < ideal {
        return None;
    }
    let mut q = ideal.min(0.9 * high);
    // As many as halve any interval down to two neighbouring numbers.
    for _ in 0..100 {
        let excess = q * (1.0 + r * q * q) - ideal;
        if excess < 0.0 {
            low = q
        } else {
            high = q
        }
        let newton = q - excess / (1.0 + 3.0 * r * q * q);
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - q).abs() <= f64::EPSILON * q {
            return Some(next);
        }
        q = next;
    }
    Some(q)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Projection; 11] = [
        Projection::Perspective,
        Projection::Equidistant,
        Projection::FieldOfView { omega: 0.9 },
        Projection::FieldOfView { omega: 0.0 },
        Projection::Division { k: -0.3 },
        Projection::Division { k: 0.2 },
        Projection::EnhancedUnified { alpha: 0.6, beta: 1.1 },
        Projection::EnhancedUnified { alpha: 0.3, beta: 0.8 },
        Projection::MeasuredRadial { r: 0.3 },
        Projection::MeasuredRadial { r: -0.1 },
        Projection::Equirectangular,
    ];

    #[test]
    fn straight_ahead_is_the_middle_and_up_is_up() {
        for projection in ALL {
            let ahead = projection.plane_from_direction(DVec3::Z * 3.0);
            assert_eq!(ahead, Some(DVec2::ZERO), "{projection:?}");
            assert_eq!(projection.direction_from_plane(DVec2::ZERO), Some(DVec3::Z), "{projection:?}");
            let aside = projection.plane_from_direction(DVec3::new(0.2, 0.1, 1.0)).unwrap();
            assert!(aside.x > 0.0 && aside.y < 0.0, "{projection:?}: {aside}");
            assert_eq!(projection.plane_from_direction(DVec3::ZERO), None, "{projection:?}");
        }
    }

    #[test]
    fn what_is_projected_comes_back() {
        for projection in ALL {
            let mut met = 0;
            for k in 0..400 {
                // A spiral over the sphere.
                let (z, turn) = (1.0 - (2 * k + 1) as f64 / 400.0, 2.4 * k as f64);
                let across = (1.0 - z * z).sqrt();
                let direction = DVec3::new(across * turn.cos(), across * turn.sin(), z);
                let Some(point) = projection.plane_from_direction(direction) else { continue };
                let back = projection.direction_from_plane(point).unwrap();
                assert!(back.abs_diff_eq(direction, 1e-8), "{projection:?}: {direction} to {back}");
                met += 1;
            }
            // Half of the sphere for what is like a pinhole, less only where two directions would share a point.
            let folds = match projection {
                Projection::Division { k } => k > 0.0,
                Projection::MeasuredRadial { r } => r < 0.0,
                _ => false,
            };
            let least = if folds { 50 } else { 200 };
            assert!(met >= least, "{projection:?}: {met}");
        }
    }

    #[test]
    fn what_is_behind_has_no_place() {
        let back = -DVec3::Z;
        assert_eq!(Projection::Perspective.plane_from_direction(DVec3::new(0.1, 0.0, -1.0)), None);
        assert_eq!(Projection::Equidistant.plane_from_direction(back), None);
        assert_eq!(Projection::FieldOfView { omega: 0.9 }.plane_from_direction(back), None);
        assert_eq!(Projection::EnhancedUnified { alpha: 0.6, beta: 1.0 }.plane_from_direction(back), None);
        assert_eq!(Projection::Equidistant.direction_from_plane(DVec2::new(3.2, 0.0)), None);
        assert_eq!(Projection::FieldOfView { omega: 0.9 }.direction_from_plane(DVec2::new(2.0, 0.0)), None);
        assert_eq!(Projection::Division { k: 1.0 }.direction_from_plane(DVec2::new(1.1, 0.0)), None);
        assert_eq!(Projection::Equirectangular.direction_from_plane(DVec2::new(0.0, 1.6)), None);
    }
}
