//! The constant part of the light as a picture, which is what textures of other programs can represent.

use super::PhotographLight;
use super::texels::TexelGrid;
use atlas::Atlas;
use glam::{DVec2, Vec3};
use rayon::prelude::*;

/// View-independent light over an atlas.
#[derive(Clone, Debug, PartialEq)]
pub struct LightTexture {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Radiance, row by row from the top; black far from any surface.
    pub pixels: Vec<Vec3>,
}

/// Charts are extended by this many texels beyond their borders, for filtering.
const MARGIN_TEXELS: i64 = 4;

impl PhotographLight {
    /// View-independent radiance over `atlas`, which must be the one that the light was made with, at the resolution of
    /// the light.
    pub fn texture(&self, atlas: &Atlas) -> LightTexture {
        let [width, height] = [self.grid.width, self.grid.height];
        let grid_of_picture = DVec2::new(
            f64::from(atlas.width) / f64::from(width),
            f64::from(atlas.height) / f64::from(height),
        ) * self.grid.scale;
        let pixel = |number: usize| {
            let at = DVec2::new((number % width as usize) as f64, (number / width as usize) as f64) + 0.5;
            self.constant_at(at * grid_of_picture)
        };
        let pixels = (0..width as usize * height as usize).into_par_iter().map(pixel).collect();
        LightTexture { size: [width, height], pixels }
    }

    fn constant_at(&self, place: DVec2) -> Vec3 {
        let around = place - 0.5;
        let (floor, share) = (around.floor(), (around - around.floor()).as_vec2());
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for [dx, dy] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let axis_weight = |step: i64, share: f32| if step == 0 { 1.0 - share } else { share };
            if let Some(texel) = self.grid.at(floor.x as i64 + dx, floor.y as i64 + dy) {
                let weight = axis_weight(dx, share.x) * axis_weight(dy, share.y);
                sum += self.constant[texel] * weight;
                weights += weight;
            }
        }
        if weights > 0.0 {
            return sum / weights;
        }
        nearest(&self.grid, place).map_or(Vec3::ZERO, |texel| self.constant[texel])
    }
}

/// The nearest texel within the margin.
fn nearest(grid: &TexelGrid, place: DVec2) -> Option<usize> {
    let (x, y) = (place.x.floor() as i64, place.y.floor() as i64);
    let steps = (-MARGIN_TEXELS..=MARGIN_TEXELS)
        .flat_map(|dy| (-MARGIN_TEXELS..=MARGIN_TEXELS).map(move |dx| (dx, dy)));
    let candidates = steps.filter_map(|(dx, dy)| Some((dx * dx + dy * dy, grid.at(x + dx, y + dy)?)));
    candidates.min().map(|(_, texel)| texel)
}
