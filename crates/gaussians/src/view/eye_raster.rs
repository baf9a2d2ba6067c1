//! The view from an aperture point on a grid of rays: which splats its tiles can meet, and their colours.

use super::GaussianView;
use super::eye::{Eye, Hit};
use super::ray_light::RayLight;
use super::tiles::{Outlines, RayGrid, TileRow};
use crate::cloud::ColorSpace;
use glam::{DVec2, Vec3};
use rayon::prelude::*;

/// An eye with the outlines and colours of the splats that its grid shows.
pub(crate) struct EyeRaster<'v> {
    pub eye: Eye<'v>,
    grid: &'v RayGrid,
    outlines: Outlines,
    /// As they are blended, and as light; empty where no light is asked for.
    colors: Vec<(Vec3, Vec3)>,
    space: ColorSpace,
}

impl<'v> EyeRaster<'v> {
    /// The eye at the aperture point `u`, scene units.
    pub fn new(view: &'v GaussianView<'v>, u: DVec2, grid: &'v RayGrid) -> Self {
        let raster = Self::without_light(view, u, grid);
        let color = |splat: u32| {
            let color = if raster.outlines.is_met(splat) { raster.eye.color(splat) } else { Vec3::ZERO };
            (color, raster.eye.decoded(color))
        };
        let colors = (0..view.len() as u32).into_par_iter().map(color).collect();
        Self { colors, ..raster }
    }

    /// The same without colours, which must not be asked for.
    pub fn without_light(view: &'v GaussianView<'v>, u: DVec2, grid: &'v RayGrid) -> Self {
        let eye = Eye::new(view, u);
        let outlines = grid.outlines(&eye);
        Self { eye, grid, outlines, colors: Vec::new(), space: view.cloud().traits().color_space }
    }

    /// A row of tiles with the splats that it meets.
    pub fn tile_row(&self, index: u32) -> TileRow<'_> {
        self.grid.tile_row(&self.outlines, index)
    }

    /// The light of a ray.
    #[inline]
    pub fn light(&self, hits: &[Hit]) -> RayLight {
        RayLight::new(hits, |splat| self.colors[splat as usize], self.space)
    }

    /// The linear light of a splat.
    #[inline]
    pub fn radiance(&self, splat: u32) -> Vec3 {
        self.colors[splat as usize].1
    }
}
