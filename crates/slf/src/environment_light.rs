//! Importance sampling of the environment.
//!
//! Radiance is bilinear between the centres of four texels ([`scene::EnvironmentMap`]), so the cells between texel
//! centres are what is sampled: each in proportion to the mean of its corners times its solid angle. Rows, then cells
//! within a row, are chosen by inverting cumulative sums, which keeps evenly distributed numbers evenly distributed
//! over directions; within a cell the direction is uniform in solid angle. A sun of one texel is the corner of four
//! cells: nowhere does the radiance exceed four times the value its cell was chosen for, so the sun neither vanishes
//! nor causes fireflies. Everything that emits light has a density above 0.

use crate::cumulative_tables::CumulativeTables;
use glam::{DQuat, DVec2, DVec3, Vec3};
use numerics::luminance;
use scene::{Environment, EnvironmentMap, World};
use std::f64::consts::TAU;
use std::sync::Arc;

/// The environment as a sampled light source.
#[derive(Debug)]
pub(crate) struct EnvironmentLight {
    map: Arc<EnvironmentMap>,
    /// Rows of cells, from the top.
    rows: CumulativeTables,
    /// The cells of each row, from the left.
    cells: CumulativeTables,
    /// Sines of the latitudes that bound each row of cells, from the top.
    sines: Vec<[f64; 2]>,
    /// From the environment's axes to the world's.
    to_world: DQuat,
    strength: f32,
}

/// Light from a direction of the environment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EnvironmentSample {
    /// Unit direction toward it, in the world.
    pub direction: DVec3,
    /// Linear RGB.
    pub radiance: Vec3,
    /// Density, 1/sr, with which the direction is sampled.
    pub density: f64,
}

impl EnvironmentLight {
    /// Builds the sampler. `None` if the world is dark or uniform: sampling the BSDF handles those best.
    pub fn from_world(world: &World) -> Option<Self> {
        let Environment::Map(map) = &world.environment else { return None };
        if world.strength <= 0.0 {
            return None;
        }
        let (width, height) = (i64::from(map.width), i64::from(map.height));
        // Cells start at texel centres; the first row ends at the first centre and the last one starts at the last
        // centre.
        let edge = |row: i64| map.row_latitude((row as f64 - 0.5).clamp(0.0, height as f64)).sin();
        let sines: Vec<[f64; 2]> = (0..=height).map(|row| [edge(row), edge(row + 1)]).collect();
        let luminance = |column, row| f64::from(luminance(map.texel(column, row).to_array()));
        let (mut rows, mut cells) = (Vec::new(), Vec::new());
        for (row, [top, bottom]) in (0i64..).zip(&sines) {
            let cell_weight = |column: i64| {
                let corners = [row - 1, row].map(|row| luminance(column, row) + luminance(column + 1, row));
                corners[0] + corners[1]
            };
            let first = cells.len();
            cells.extend((0..width).map(cell_weight));
            rows.push(cells[first..].iter().sum::<f64>() * (top - bottom));
        }
        let rows_sum: f64 = rows.iter().sum();
        (rows_sum > 0.0 && rows_sum.is_finite()).then(|| Self {
            map: map.clone(),
            rows: CumulativeTables::new(rows.len(), &rows),
            cells: CumulativeTables::new(map.width as usize, &cells),
            sines,
            to_world: DQuat::from_rotation_y(world.rotation),
            strength: world.strength,
        })
    }

    /// Samples a direction from uniform numbers.
    pub fn sample(&self, u: [f64; 2]) -> EnvironmentSample {
        let (row, down) = self.rows.invert(0, u[1]);
        let (column, along) = self.cells.invert(row, u[0]);
        let [top, bottom] = self.sines[row];
        let sine = top + (bottom - top) * down;
        let position = column as f64 + 0.5 + along;
        let longitude = (position / f64::from(self.map.width) - 0.5) * TAU;
        let flat = (1.0 - sine * sine).max(0.0).sqrt();
        let direction = DVec3::new(longitude.cos() * flat, sine, longitude.sin() * flat);
        EnvironmentSample {
            direction: self.to_world * direction,
            radiance: self.map.radiance_at(DVec2::new(position, self.map.row_of_sine(sine))) * self.strength,
            density: self.density_of_cell(row, column),
        }
    }

    /// What arrives from a direction (unit, world), as it would be sampled.
    pub fn along(&self, direction: DVec3) -> EnvironmentSample {
        let position = self.map.texel_position(self.to_world.conjugate() * direction);
        let cell = position - 0.5;
        let column = (cell.x.floor() as i64).rem_euclid(i64::from(self.map.width));
        let row = (cell.y.floor() as i64 + 1).clamp(0, i64::from(self.map.height));
        EnvironmentSample {
            direction,
            radiance: self.map.radiance_at(position) * self.strength,
            density: self.density_of_cell(row as usize, column as usize),
        }
    }

    fn density_of_cell(&self, row: usize, column: usize) -> f64 {
        let [top, bottom] = self.sines[row];
        let probability = self.rows.probability(0, row) * self.cells.probability(row, column);
        probability / ((top - bottom) * TAU / f64::from(self.map.width))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A dim sky with a sun of one texel.
    fn sunny(sun: f32) -> World {
        let (width, height) = (64u32, 32u32);
        let mut texels = vec![[0.2f32, 0.3, 0.5]; (width * height) as usize];
        texels[(9 * width + 63) as usize] = [sun; 3];
        let map = EnvironmentMap { name: "sky".into(), width, height, texels };
        World { environment: Environment::Map(Arc::new(map)), ..World::uniform(Vec3::ZERO) }
    }

    fn spread(count: u32) -> impl Iterator<Item = [f64; 2]> {
        // Steps of Roberts's R2 sequence.
        const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
        (0..count).map(|k| STEPS.map(|step| (f64::from(k) * step + 0.5).fract()))
    }

    #[test]
    fn density_is_of_what_is_drawn_and_sums_to_one() {
        let world = World { rotation: 0.7, strength: 2.0, ..sunny(1e5) };
        let light = EnvironmentLight::from_world(&world).unwrap();
        for [a, b] in spread(5000) {
            let EnvironmentSample { direction, radiance, density } = light.sample([a, b]);
            assert!((direction.length() - 1.0).abs() < 1e-12);
            let again = light.along(direction);
            assert!((again.density / density - 1.0).abs() < 1e-9, "{direction}: {density} {again:?}");
            for seen in [again.radiance, world.radiance(direction)] {
                assert!(
                    (seen - radiance).abs().max_element() < 1e-3 * radiance.max_element(),
                    "{seen} {radiance}"
                );
            }
        }
        let n = 2000u32;
        let mut sum = 0.0;
        for k in 0..n * n / 4 {
            let (u, v) = (f64::from(k % n) + 0.5, f64::from(k / n) + 0.5);
            let sine = 1.0 - 2.0 * v / f64::from(n / 4);
            let turn = TAU * u / f64::from(n);
            let flat = (1.0 - sine * sine).sqrt();
            sum += light.along(DVec3::new(flat * turn.cos(), sine, flat * turn.sin())).density;
        }
        let whole = sum * 2.0 * TAU / f64::from(n * n / 4);
        assert!((whole - 1.0).abs() < 5e-3, "{whole}");
    }

    #[test]
    fn a_sun_of_one_texel_does_not_sparkle() {
        for sun in [0.3, 10.0, 1e3, 1e5] {
            let world = sunny(sun);
            let light = EnvironmentLight::from_world(&world).unwrap();
            let ratios: Vec<f64> = spread(20_000)
                .map(|[a, b]| {
                    let EnvironmentSample { direction, density, .. } = light.sample([a, b]);
                    f64::from(world.radiance(direction).y) / density
                })
                .collect();
            let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
            let max = ratios.iter().copied().fold(0.0, f64::max);
            assert!(max < 4.2 * mean, "{sun}: {max} of {mean}");
            // Light of the sun alone: its peak integrated over the pyramid that bilinear interpolation makes of one
            // texel.
            let latitude = std::f64::consts::FRAC_PI_2 - 9.5 / 32.0 * std::f64::consts::PI;
            let texel = (std::f64::consts::PI / 32.0).powi(2) * latitude.cos();
            let expected = 0.3 * 4.0 * std::f64::consts::PI + f64::from(sun - 0.3) * texel;
            assert!((mean / expected - 1.0).abs() < 0.02, "{sun}: {mean}, expected {expected}");
        }
    }

    #[test]
    fn darkness_and_uniform_light_need_no_search() {
        assert!(EnvironmentLight::from_world(&World::uniform(Vec3::ONE)).is_none());
        assert!(EnvironmentLight::from_world(&World { strength: 0.0, ..sunny(1.0) }).is_none());
    }
}
