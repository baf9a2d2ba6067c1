//! Importance sampling of the environment.
//!
//! Radiance is bilinear between the centres of four texels ([`scene::EnvironmentMap`]), so the cells between texel
//! centres are what is sampled: each in proportion to the mean of its corners times its solid angle. Rows, then cells
//! within a row, are chosen by inverting cumulative sums, which keeps evenly distributed numbers evenly distributed
//! over directions; within a cell the direction is uniform in solid angle. A sun of one texel is the corner of four
//! cells: nowhere does the radiance exceed four times the value its cell was chosen for, so the sun neither vanishes
//! nor causes fireflies. Everything that emits light has a density above 0.

use glam::{DVec2, DVec3};
use numerics::luminance;
use scene::{Environment, EnvironmentMap, World};
use std::f64::consts::TAU;
use std::sync::Arc;

/// The environment as a sampled light source.
#[derive(Debug)]
pub(crate) struct EnvironmentLight {
    map: Arc<EnvironmentMap>,
    /// Cumulative probabilities of rows of cells, from the top; starts with 0.
    rows: Vec<f64>,
    /// Cumulative probabilities of the cells of each row, given the row, from the left; each row starts with 0.
    cells: Vec<f64>,
    /// Sines of the latitudes that bound each row of cells, from the top.
    sines: Vec<[f64; 2]>,
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
            let weights: Vec<f64> = (0..width).map(cell_weight).collect();
            rows.push(weights.iter().sum::<f64>() * (top - bottom));
            cells.extend(cumulative_shares(&weights));
        }
        let rows_sum: f64 = rows.iter().sum();
        let rows = cumulative_shares(&rows);
        (rows_sum > 0.0 && rows_sum.is_finite()).then(|| Self { map: map.clone(), rows, cells, sines })
    }

    /// Cumulative probabilities of the cells of a row.
    fn row(&self, row: usize) -> &[f64] {
        let ends = self.map.width as usize + 1;
        &self.cells[row * ends..(row + 1) * ends]
    }

    /// Samples a direction in the environment's own axes from uniform numbers; returns it with its density, 1/sr.
    pub fn sample(&self, u: [f64; 2]) -> (DVec3, f64) {
        let (row, down) = invert_cumulative(&self.rows, u[1]);
        let (column, along) = invert_cumulative(self.row(row), u[0]);
        let [top, bottom] = self.sines[row];
        let sine = top + (bottom - top) * down;
        let position = column as f64 + 0.5 + along;
        let longitude = self.map.direction_at(DVec2::new(position, f64::from(self.map.height) / 2.0));
        let flat = (1.0 - sine * sine).max(0.0).sqrt();
        let direction = DVec3::new(longitude.x * flat, sine, longitude.z * flat);
        (direction, self.density_of_cell(row, column))
    }

    /// Density, 1/sr, with which a direction in the environment's own axes is sampled.
    pub fn density(&self, direction: DVec3) -> f64 {
        let at = self.map.texel_position(direction) - 0.5;
        let column = (at.x.floor() as i64).rem_euclid(i64::from(self.map.width));
        let row = (at.y.floor() as i64 + 1).clamp(0, i64::from(self.map.height));
        self.density_of_cell(row as usize, column as usize)
    }

    fn density_of_cell(&self, row: usize, column: usize) -> f64 {
        let [top, bottom] = self.sines[row];
        let cells = self.row(row);
        let probability = (self.rows[row + 1] - self.rows[row]) * (cells[column + 1] - cells[column]);
        probability / ((top - bottom) * TAU / f64::from(self.map.width))
    }
}

/// Cumulative sums of weights, scaled to end at 1; starts with 0. Even steps if all weights are 0.
fn cumulative_shares(weights: &[f64]) -> Vec<f64> {
    let sum: f64 = weights.iter().sum();
    let (terms, total) =
        if sum > 0.0 { (weights.to_vec(), sum) } else { (vec![1.0; weights.len()], weights.len() as f64) };
    let mut sum_so_far = 0.0;
    let mut steps = vec![0.0];
    steps.extend(terms.iter().map(|weight| {
        sum_so_far += weight;
        (sum_so_far / total).min(1.0)
    }));
    steps[weights.len()] = 1.0;
    steps
}

/// The interval of cumulative sums that contains a uniform number, and the relative position within it.
fn invert_cumulative(steps: &[f64], u: f64) -> (usize, f64) {
    let step = steps.partition_point(|&sum| sum <= u).clamp(1, steps.len() - 1) - 1;
    let (from, to) = (steps[step], steps[step + 1]);
    (step, if to > from { ((u - from) / (to - from)).clamp(0.0, 1.0) } else { 0.5 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

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
        let light = EnvironmentLight::from_world(&sunny(1e5)).unwrap();
        for [a, b] in spread(5000) {
            let (direction, density) = light.sample([a, b]);
            assert!((direction.length() - 1.0).abs() < 1e-12);
            let again = light.density(direction);
            assert!((again / density - 1.0).abs() < 1e-9, "{direction}: {density} {again}");
        }
        let n = 2000u32;
        let mut sum = 0.0;
        for k in 0..n * n / 4 {
            let (u, v) = (f64::from(k % n) + 0.5, f64::from(k / n) + 0.5);
            let sine = 1.0 - 2.0 * v / f64::from(n / 4);
            let turn = TAU * u / f64::from(n);
            let flat = (1.0 - sine * sine).sqrt();
            sum += light.density(DVec3::new(flat * turn.cos(), sine, flat * turn.sin()));
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
                    let (direction, density) = light.sample([a, b]);
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
