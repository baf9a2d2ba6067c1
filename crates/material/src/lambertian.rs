//! A white surface that scatters evenly, which measures what light arrives.

use crate::bsdf::cosine_weighted;
use crate::frame::Frame;
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_1_PI;

/// A Lambertian surface of albedo 1: the light that it scatters is the irradiance/π that arrives.
#[derive(Clone, Copy, Debug)]
pub struct Lambertian {
    frame: Frame,
}

impl Lambertian {
    /// The surface with these unit normals (world): that of the triangle and that of its shading, on the side where light is received.
    pub fn new(geometric: DVec3, normal: DVec3) -> Self {
        Self { frame: Frame::new(geometric, normal, DVec3::ZERO) }
    }

    /// The share of the radiance from a direction (unit, world) that is scattered, 1/sr: the cosine over π, with the shadow terminator of
    /// shading normals; and the density, 1/sr, with which [`Self::sample`] chooses the direction.
    pub fn scatter(&self, incident: DVec3) -> (f64, f64) {
        let cosine = self.frame.normal.dot(incident);
        if cosine <= 0.0 || self.frame.geometric.dot(incident) <= 0.0 {
            return (0.0, 0.0);
        }
        let density = cosine * FRAC_1_PI;
        (density * self.frame.terminator(incident), density)
    }

    /// Samples a direction from uniform numbers in [0, 1); returns it with its density, 1/sr, and the share of its radiance that is scattered
    /// over that density. `None` if it lies behind the triangle.
    pub fn sample(&self, u: [f64; 2]) -> Option<(DVec3, f64, f64)> {
        let incident = self.frame.world(cosine_weighted(DVec2::from_array(u)));
        let (scattered, density) = self.scatter(incident);
        (scattered > 0.0).then(|| (incident, density, scattered / density))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_from_everywhere_is_scattered_whole_where_the_normals_agree() {
        let surface = Lambertian::new(DVec3::Y, DVec3::Y);
        let leaning = Lambertian::new(DVec3::Y, DVec3::new(0.5, 1.0, 0.0).normalize());
        let steps = 200;
        let mean = |surface: &Lambertian| {
            let numbers =
                (0..steps * steps).map(|k| [k % steps, k / steps].map(|n| (f64::from(n) + 0.5) / 200.0));
            let weights = numbers.map(|u| surface.sample(u).map_or(0.0, |(.., weight)| weight));
            weights.sum::<f64>() / f64::from(steps * steps)
        };
        assert!((mean(&surface) - 1.0).abs() < 1e-9);
        assert!((0.8..0.95).contains(&mean(&leaning)), "{}", mean(&leaning));
    }

    #[test]
    fn nothing_arrives_from_behind_either_normal() {
        let surface = Lambertian::new(DVec3::Y, DVec3::new(1.0, 1.0, 0.0).normalize());
        for behind in
            [DVec3::NEG_Y, DVec3::new(1.0, -0.1, 0.0).normalize(), DVec3::new(-1.0, 0.5, 0.0).normalize()]
        {
            assert_eq!(surface.scatter(behind), (0.0, 0.0), "{behind}");
        }
    }
}
