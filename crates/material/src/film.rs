//! Iridescence: a thin film on the surface (Belcour and Barla 2017, *A practical extension to microfacet theory for the modeling of
//! varying iridescence*), as in KHR_materials_iridescence: two orders of interference, Schlick's reflectance at the inner interface
//! (Fresnel's at the outer one, so that a film that vanishes changes nothing at any angle), and the eye's sensitivities as Gaussians
//! over the phase.

use crate::fresnel::{dielectric_reflectance, reflectance_of_ior, rise, schlick};
use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};

/// A thin film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// The share of the surface that has it, in [0, 1].
    pub factor: f64,
    /// Index of refraction, ≥ 1.
    pub ior: f64,
    /// nm, ≥ 0.
    pub thickness: f64,
}

/// CIE XYZ to linear sRGB, by columns.
const RGB_OF_XYZ: DMat3 = DMat3::from_cols_array(&[
    3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314, 0.0415560, 1.0572252,
]);

impl Film {
    /// The reflectance with the film on a surface of reflectance F0, by the cosine outside; in [0, 1].
    pub fn reflectance(&self, f0: DVec3, cos: f64) -> DVec3 {
        // The index of a film that vanishes is that of air, so that nothing jumps where it ends.
        let x = (self.thickness / 0.03).clamp(0.0, 1.0);
        let ior = 1.0 + (self.ior - 1.0) * x * x * (3.0 - 2.0 * x);
        let cos2_within = 1.0 - (1.0 - cos * cos) / (ior * ior);
        if cos2_within <= 0.0 {
            return DVec3::ONE;
        }
        let cos_within = cos2_within.sqrt();
        let outer = dielectric_reflectance(cos, ior);
        let through = 1.0 - outer;
        let base = f0.clamp(DVec3::ZERO, DVec3::splat(0.9999)).map(ior_of_reflectance);
        let inner = schlick(base.map(|base| reflectance_of_ior(base / ior)), DVec3::ONE, cos_within);
        let shift = base.map(|base| PI + if base < ior { PI } else { 0.0 });
        let both = (inner * outer).clamp(DVec3::ZERO, DVec3::splat(0.9999));
        let all = through * through * inner / (DVec3::ONE - both);
        let path = 2.0 * ior * self.thickness * cos_within;
        let mut sum = all + outer;
        let mut order = all - through;
        for m in [1.0, 2.0] {
            order *= both.map(f64::sqrt);
            sum += order * 2.0 * sensitivity(m * path, shift * m);
        }
        sum.clamp(DVec3::ZERO, DVec3::ONE)
    }

    /// The F0 with which Schlick's reflectance is the film's at this cosine. A film may reflect less than any F0 would: the result is then
    /// negative, and the reflectance computed from it is not.
    pub fn f0(&self, f0: DVec3, cos: f64) -> DVec3 {
        let risen = rise(cos);
        // At the very horizon the reflectance does not depend on F0.
        let rest = (1.0 - risen).max(1e-6);
        ((self.reflectance(f0, cos) - risen) / rest)
            .clamp(DVec3::NEG_ONE, DVec3::splat(2.0))
            .lerp(f0, 1.0 - self.factor)
    }
}

fn ior_of_reflectance(f0: f64) -> f64 {
    let root = f0.sqrt();
    (1.0 + root) / (1.0 - root)
}

/// The colour of an order of interference, linear RGB, for a path difference, nm, and a phase shift.
fn sensitivity(path: f64, shift: DVec3) -> DVec3 {
    let phase = TAU * path * 1e-9;
    let gaussian = |height: f64, place: f64, width: f64, shift: f64| {
        height * (TAU * width).sqrt() * (place * phase + shift).cos() * (-phase * phase * width).exp()
    };
    let xyz = DVec3::new(
        gaussian(5.4856e-13, 1.6810e6, 4.3278e9, shift.x) + gaussian(9.7470e-14, 2.2399e6, 4.5282e9, shift.x),
        gaussian(4.4201e-13, 1.7953e6, 9.3046e9, shift.y),
        gaussian(5.2481e-13, 2.2084e6, 6.6121e9, shift.z),
    );
    RGB_OF_XYZ * (xyz / 1.0685e-7)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GLASS: DVec3 = DVec3::splat(0.04);

    #[test]
    fn a_film_that_vanishes_is_not_there() {
        let film = Film { factor: 1.0, ior: 1.8, thickness: 0.0 };
        for cos in [0.05, 0.3, 0.7, 1.0] {
            let (with, without) = (film.reflectance(GLASS, cos), schlick(GLASS, DVec3::ONE, cos));
            assert!(with.distance(without) < 1e-4, "{cos}: {with}, not {without}");
        }
        let none = Film { factor: 0.0, ior: 1.8, thickness: 400.0 };
        assert_eq!(none.f0(GLASS, 0.5), GLASS);
    }

    #[test]
    fn colours_change_with_thickness_and_angle() {
        let at = |thickness, cos| Film { factor: 1.0, ior: 1.33, thickness }.reflectance(GLASS, cos);
        // A soap film a quarter wave thick mirrors green most, one a half wave thick least.
        let (quarter, half) = (at(103.0, 1.0), at(206.0, 1.0));
        assert!(quarter.y > 1.2 * half.y || half.y > 1.2 * quarter.y, "{quarter} {half}");
        let spread = |rgb: DVec3| rgb.max_element() / rgb.min_element();
        assert!(spread(at(400.0, 1.0)) > 1.2);
        assert!(at(400.0, 1.0).distance(at(400.0, 0.5)) > 5e-3);
    }

    #[test]
    fn it_makes_no_light_and_no_nonsense() {
        for thickness in [0.0, 0.01, 1.0, 150.0, 600.0, 1e5] {
            for ior in [1.0, 1.3, 2.5, 10.0] {
                for f0 in [DVec3::ZERO, GLASS, DVec3::new(1.0, 0.7, 0.3), DVec3::ONE] {
                    for cos in [0.0, 1e-6, 0.4, 1.0] {
                        let film = Film { factor: 0.7, ior, thickness };
                        let mirrored = schlick(film.f0(f0, cos), DVec3::ONE, cos);
                        for rgb in [film.reflectance(f0, cos), mirrored] {
                            let sane = rgb.min_element() >= -1e-6 && rgb.max_element() <= 1.0 + 1e-6;
                            assert!(sane, "{film:?} {f0} {cos}: {rgb}");
                        }
                    }
                }
            }
        }
    }
}
