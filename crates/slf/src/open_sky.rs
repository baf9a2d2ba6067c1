//! Irradiance of an unoccluded environment, tabulated by normal.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use scene::{Environment, EnvironmentMap, World};
use std::f64::consts::{PI, TAU};

/// Irradiance/π by normal, over longitude and latitude as in an environment map.
#[derive(Debug)]
pub(crate) struct OpenSky {
    values: EnvironmentMap,
}

/// Size of the table. Bilinear interpolation is off by a thousandth of a sky's light, and by three thousandths of a
/// sun's at its horizon.
const NORMALS: [u32; 2] = [256, 128];
/// The sky is binned into this many cells, each with the mean direction of its light.
const CELLS: [usize; 2] = [128, 64];

impl OpenSky {
    /// Tabulates the environment. `None` if the world is dark or uniform: such light is not sampled.
    pub fn from_world(world: &World) -> Option<Self> {
        match &world.environment {
            Environment::Map(map) if world.strength > 0.0 => Some(Self::from_map(map)),
            _ => None,
        }
    }

    fn from_map(map: &EnvironmentMap) -> Self {
        let cells = binned_flux(map);
        let mut values =
            EnvironmentMap { name: String::new(), width: NORMALS[0], height: NORMALS[1], texels: Vec::new() };
        let at = |k: u32| {
            values.direction_at(DVec2::new(f64::from(k % NORMALS[0]), f64::from(k / NORMALS[0])) + 0.5)
        };
        let texels = (0..NORMALS[0] * NORMALS[1])
            .into_par_iter()
            .map(|k| {
                let normal = at(k);
                let lit = |(from, flux): &(DVec3, DVec3)| *flux * normal.dot(*from).max(0.0);
                (cells.iter().map(lit).sum::<DVec3>() / PI).as_vec3().to_array()
            })
            .collect();
        values.texels = texels;
        Self { values }
    }

    /// Irradiance/π, linear RGB, of an unoccluded surface with this unit normal, in the world that the table was made
    /// for.
    pub fn at(&self, world: &World, normal: DVec3) -> DVec3 {
        self.values.radiance(world.environment_from_world(normal)).as_dvec3() * f64::from(world.strength)
    }
}

/// Directions (shorter than 1 where a cell's light comes from several) with radiance times solid angle.
fn binned_flux(map: &EnvironmentMap) -> Vec<(DVec3, DVec3)> {
    /// Each texel is subdivided this often so that the bilinear radiance between texel centres is integrated well.
    const CUTS: u32 = 2;
    let (width, height) = (map.width * CUTS, map.height * CUTS);
    let mut sums = vec![(DVec3::ZERO, DVec3::ZERO, 0.0); CELLS[0] * CELLS[1]];
    for y in 0..height {
        let edge = |row: u32| map.row_latitude(f64::from(row) / f64::from(CUTS)).sin();
        let solid_angle = (edge(y) - edge(y + 1)) * TAU / f64::from(width);
        for x in 0..width {
            let position = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) / f64::from(CUTS);
            let direction = map.direction_at(position);
            let flux = map.radiance(direction).as_dvec3() * solid_angle;
            let bin = |place: u32, cells: usize, whole: u32| place as usize * cells / whole as usize;
            let cell = bin(y, CELLS[1], height) * CELLS[0] + bin(x, CELLS[0], width);
            let (toward, sum, weight) = &mut sums[cell];
            let bright = flux.element_sum();
            *toward += direction * bright;
            *sum += flux;
            *weight += bright;
        }
    }
    sums.into_iter()
        .filter(|(.., weight)| *weight > 0.0)
        .map(|(toward, sum, weight)| (toward / weight, sum))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_integral_over_the_hemisphere() {
        // Radiance 1 from above and 0.25 from below, and a sun.
        let (width, height) = (128, 64);
        let mut texels: Vec<[f32; 3]> =
            (0..width * height).map(|k| if k / width < height / 2 { [1.0; 3] } else { [0.25; 3] }).collect();
        texels[(16 * width + 70) as usize] = [2000.0; 3];
        let map = EnvironmentMap { name: "sky".into(), width, height, texels };
        let world =
            World { environment: Environment::Map(map.clone().into()), ..World::uniform(glam::Vec3::ZERO) };
        let sky = OpenSky::from_world(&world).unwrap();
        assert!(OpenSky::from_world(&World::uniform(glam::Vec3::ONE)).is_none());
        let sun = map.direction_at(DVec2::new(70.5, 16.5));
        let texel = (PI / f64::from(height)).powi(2) * map.row_latitude(16.5).cos();
        for normal in
            [DVec3::Y, DVec3::NEG_Y, DVec3::X, DVec3::new(0.3, 0.8, -0.52), DVec3::new(-0.7, 0.1, 0.7)]
        {
            let normal = normal.normalize();
            let share = (1.0 + normal.y) / 2.0;
            let expected = share + 0.25 * (1.0 - share) + 1999.0 * texel * normal.dot(sun).max(0.0) / PI;
            let irradiance = sky.at(&world, normal).x;
            assert!((irradiance / expected - 1.0).abs() < 0.012, "{normal}: {irradiance}, not {expected}");
        }
    }
}
