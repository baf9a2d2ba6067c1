//! The reflectance of an interface.

use glam::DVec3;

/// F0 of an interface between vacuum and an index of refraction: ((n − 1)/(n + 1))².
pub fn reflectance_of_ior(ior: f64) -> f64 {
    ((ior - 1.0) / (ior + 1.0)).powi(2)
}

/// (1 − cos)⁵: how far Schlick's reflectance has risen from F0 to F90.
pub(crate) fn rise(cos: f64) -> f64 {
    (1.0 - cos).clamp(0.0, 1.0).powi(5)
}

/// Schlick's reflectance (1994), F0 + (F90 − F0)(1 − cos)⁵, per colour and in [0, 1]; `cos` is that of the angle of
/// incidence.
pub fn schlick(f0: DVec3, f90: DVec3, cos: f64) -> DVec3 {
    f0 + (f90 - f0) * rise(cos)
}

/// The mean of Schlick's reflectance over the cosine-weighted hemisphere, F0 + (F90 − F0)/21.
pub(crate) fn schlick_mean(f0: DVec3, f90: DVec3) -> DVec3 {
    f0 + (f90 - f0) / 21.0
}

/// The reflectance of a dielectric for unpolarised light (Fresnel): `cos` in [0, 1] on the side that the light comes from, `eta` the index
/// of refraction on the far side over that on the near side. 1 beyond the critical angle, 0 for equal media at any angle.
pub fn dielectric_reflectance(cos: f64, eta: f64) -> f64 {
    if eta == 1.0 {
        return 0.0;
    }
    let cos = cos.clamp(0.0, 1.0);
    let sin2_beyond = (1.0 - cos * cos) / (eta * eta);
    if sin2_beyond >= 1.0 {
        return 1.0;
    }
    let cos_beyond = (1.0 - sin2_beyond).sqrt();
    let parallel = (eta * cos - cos_beyond) / (eta * cos + cos_beyond);
    let perpendicular = (cos - eta * cos_beyond) / (cos + eta * cos_beyond);
    (parallel * parallel + perpendicular * perpendicular) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fresnel_has_its_textbook_values() {
        assert!((dielectric_reflectance(1.0, 1.5) - 0.04).abs() < 1e-12);
        assert!((dielectric_reflectance(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-12);
        assert_eq!(dielectric_reflectance(0.0, 1.5), 1.0, "grazing");
        assert_eq!(dielectric_reflectance(0.5, 1.0 / 1.5), 1.0, "total");
        for cos in [0.0, 0.3, 1.0] {
            assert_eq!(dielectric_reflectance(cos, 1.0), 0.0, "nothing between equal media");
        }
        // Brewster's angle: only half of the light, polarised across, is reflected at all.
        let brewster = 1.5f64.atan().cos();
        assert!((dielectric_reflectance(brewster, 1.5) - 0.0740).abs() < 1e-4);
        // The same from either side, at the refracted angle.
        let cos_beyond = (1.0 - (1.0 - 0.36) / 2.25f64).sqrt();
        let [a, b] = [dielectric_reflectance(0.6, 1.5), dielectric_reflectance(cos_beyond, 1.0 / 1.5)];
        assert!((a - b).abs() < 1e-12);
    }
}
