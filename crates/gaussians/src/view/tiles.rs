//! Which splats the rays of a part of the picture can meet.
//!
//! Rays form a grid. A splat's outline as an eye sees it is a conic; the tiles that its bounds meet are those whose rays must test it. Splats are
//! listed by rows of tiles, and those of a row by tiles when it is drawn; what spans many is listed once, so that nothing grows with splats times tiles.

use super::eye::Eye;
use super::shape::CameraShape;
use super::span_bins::SpanBins;
use super::tile_tracer::{LANES, TileTracer};
use super::{GaussianView, ViewSplat};
use glam::{DVec2, DVec3, Vec2};
use rayon::prelude::*;
use std::ops::{Range, RangeInclusive};

/// Rays of a side of a tile: a row of them is traced at once.
pub(crate) const TILE: u32 = LANES as u32;

/// The rays of a grid between which a splat is, whole numbers, perhaps beyond the grid.
struct RayBounds {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

/// Rays through a picture and a margin about it, evenly spaced.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayGrid {
    /// Rays of a pixel's side, at least 1.
    pub rays_per_px: u32,
    /// Pixels about the picture.
    pub margin_px: u32,
    /// Rays of a row.
    pub columns: u32,
    /// Rows of rays.
    pub rows: u32,
}

/// A row of tiles.
pub(crate) struct TileRow<'g> {
    grid: &'g RayGrid,
    outlines: &'g Outlines,
    /// Its rows of rays.
    pub rays: Range<u32>,
    /// The splats that it meets, by tiles.
    splats: SpanBins,
}

/// The splats of a view as an eye sees them.
pub(crate) struct Outlines {
    /// In rays: first and last column, first and last row; the first is after the last where a splat is not visible.
    bounds: Vec<[u32; 4]>,
    /// By rows of tiles.
    by_row: SpanBins,
}

const HIDDEN: [u32; 4] = [TILE, 0, TILE, 0];

impl Outlines {
    /// Whether a ray of the grid can meet a splat.
    pub fn is_met(&self, splat: u32) -> bool {
        self.bounds[splat as usize] != HIDDEN
    }
}

impl RayGrid {
    /// The rays of a picture of `width` × `height` px.
    pub fn new(width: u32, height: u32, margin_px: u32, rays_per_px: u32) -> Self {
        let rays = |side: u32| side.saturating_add(margin_px.saturating_mul(2)).saturating_mul(rays_per_px);
        Self { rays_per_px, margin_px, columns: rays(width), rows: rays(height) }
    }

    /// The pixel position of a ray.
    pub fn pixel(&self, column: u32, row: u32) -> DVec2 {
        let at =
            |index: u32| (f64::from(index) + 0.5) / f64::from(self.rays_per_px) - f64::from(self.margin_px);
        DVec2::new(at(column), at(row))
    }

    /// The ray (column, row) that is nearest to a pixel position.
    #[inline]
    pub fn ray_at(&self, pixel: Vec2) -> [u32; 2] {
        let ray = (pixel + self.margin_px as f32) * self.rays_per_px as f32;
        // What is left of the first, or above it, becomes 0.
        let nearest = |ray: f32, count: u32| (ray as u32).min(count - 1);
        [nearest(ray.x, self.columns), nearest(ray.y, self.rows)]
    }

    /// The number of tiles of a row.
    pub fn tile_columns(&self) -> u32 {
        self.columns.div_ceil(TILE)
    }

    /// The number of rows of tiles.
    pub fn tile_rows(&self) -> u32 {
        self.rows.div_ceil(TILE)
    }

    /// The bounds of all splats as an eye sees them.
    pub fn outlines(&self, eye: &Eye<'_>) -> Outlines {
        let outline = |splat: &ViewSplat| self.outline(eye.view(), eye.point(), &splat.shape);
        let bounds: Vec<[u32; 4]> = eye.view().splats().par_iter().map(outline).collect();
        let rows =
            (0..).zip(&bounds).map(|(splat, [_, _, top, bottom])| (splat, [*top / TILE, *bottom / TILE]));
        Outlines { by_row: SpanBins::new(self.tile_rows(), rows), bounds }
    }

    /// The splats of a view, in order, that rays of some rows of tiles can meet, from whatever point of the aperture.
    ///
    /// Where the ray through a point of an ellipsoid is on the grid is linear in the aperture point. So what rows an ellipsoid spans from all of the aperture
    /// is what it spans from its lower and its upper end.
    pub fn seen_in_rows(&self, view: &GaussianView<'_>, rows: RangeInclusive<u32>) -> Vec<u32> {
        let radius = view.optics().aperture_radius;
        let is_seen = |splat: &ViewSplat| {
            let [a, b] = [-radius, radius].map(|y| self.ray_bounds(view, DVec2::new(0.0, y), &splat.shape));
            let tile = |ray: f64| ray.clamp(0.0, f64::from(self.rows - 1)) as u32 / TILE;
            let (top, bottom) = (a.top.min(b.top), a.bottom.max(b.bottom));
            tile(top) <= *rows.end() && *rows.start() <= tile(bottom)
        };
        let numbered = view.splats().par_iter().enumerate();
        numbered.filter(|(_, splat)| is_seen(splat)).map(|(number, _)| number as u32).collect()
    }

    /// The bounds of a splat as it is seen from the aperture point `u`.
    fn ray_bounds(&self, view: &GaussianView<'_>, u: DVec2, shape: &CameraShape) -> RayBounds {
        let (right, bottom) = (f64::from(self.columns - 1), f64::from(self.rows - 1));
        let Some([least, most]) = slope_bounds(shape, u) else {
            return RayBounds { left: 0.0, right, top: 0.0, bottom };
        };
        let ray = |slope: DVec2| {
            let slope = slope + u * view.optics().inverse_focus_distance;
            let pixel = view.camera().pixel_from_q(slope / view.optics().tan_half_yfov);
            (pixel + f64::from(self.margin_px)) * f64::from(self.rays_per_px) - 0.5
        };
        let (from, to) = (ray(DVec2::new(least.x, most.y)), ray(DVec2::new(most.x, least.y)));
        RayBounds { left: from.x.floor(), right: to.x.ceil(), top: from.y.floor(), bottom: to.y.ceil() }
    }

    fn outline(&self, view: &GaussianView<'_>, u: DVec2, shape: &CameraShape) -> [u32; 4] {
        let RayBounds { left, right, top, bottom } = self.ray_bounds(view, u, shape);
        let last = [self.columns - 1, self.rows - 1].map(f64::from);
        if right < 0.0 || bottom < 0.0 || left > last[0] || top > last[1] {
            return HIDDEN;
        }
        let ray = |ray: f64, last: f64| ray.clamp(0.0, last) as u32;
        [ray(left, last[0]), ray(right, last[0]), ray(top, last[1]), ray(bottom, last[1])]
    }

    /// A row of tiles with the splats that it meets.
    pub fn tile_row<'g>(&'g self, outlines: &'g Outlines, index: u32) -> TileRow<'g> {
        let columns = |splat: u32| {
            let [left, right, ..] = outlines.bounds[splat as usize];
            (splat, [left / TILE, right / TILE])
        };
        let splats: Vec<_> = outlines.by_row.at(index).map(columns).collect();
        TileRow {
            grid: self,
            outlines,
            rays: index * TILE..(index * TILE + TILE).min(self.rows),
            splats: SpanBins::new(self.tile_columns(), splats.iter().copied()),
        }
    }
}

impl TileRow<'_> {
    /// Visits the tiles from left to right: their columns of rays, and what these can meet.
    pub fn for_each_tile(&self, eye: &Eye<'_>, mut visit: impl FnMut(Range<u32>, &TileTracer)) {
        for tile in 0..self.grid.tile_columns() {
            visit(tile * TILE..(tile * TILE + TILE).min(self.grid.columns), &self.tracer(eye, tile));
        }
    }

    /// What the rays of a tile can meet.
    pub fn tracer(&self, eye: &Eye<'_>, tile: u32) -> TileTracer {
        let middle = self.grid.pixel(tile * TILE + TILE / 2, self.rays.start + TILE / 2);
        let rows = |splat: u32| {
            let [.., top, bottom] = self.outlines.bounds[splat as usize];
            (splat, [top, bottom])
        };
        TileTracer::new(eye, eye.view().direction(eye.point(), middle), self.splats.at(tile).map(rows))
    }
}

/// The least and the largest slopes (x/z, y/z) of rays from the aperture point `u` that meet a splat's ellipsoid at its cutoff; `None` if it reaches
/// the plane of the aperture, so that they are unbounded.
///
/// The rays' slopes form a conic, whose dual is C = r² S − v vᵀ with v = m − U; its bounds are the roots of C₃₃ x² − 2 C₁₃ x + C₁₁ = 0.
fn slope_bounds(shape: &CameraShape, u: DVec2) -> Option<[DVec2; 2]> {
    let v = shape.mean - u.extend(0.0);
    let [xx, _, yy, xz, yz, zz] = shape.covariance().map(|element| element * shape.cutoff);
    let DVec3 { x, y, z } = v;
    let c33 = zz - z * z;
    // Nearly there, the bounds are nearly infinite, and rounding decides.
    if c33 > -1e-9 * z * z {
        return None;
    }
    let bounds = |c13: f64, c11: f64| {
        let (middle, half) = (c13 / c33, (c13 * c13 - c11 * c33).max(0.0).sqrt() / -c33);
        (middle - half, middle + half)
    };
    let (horizontal, vertical) = (bounds(xz - x * z, xx - x * x), bounds(yz - y * z, yy - y * y));
    Some([DVec2::new(horizontal.0, vertical.0), DVec2::new(horizontal.1, vertical.1)])
}
