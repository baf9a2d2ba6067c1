//! The ground truth: rays uniform over picture and aperture.
//!
//! The picture from each aperture point is traced; a splat that a ray meets at z brings its share of the ray's light to
//!
//! ```text
//! q = ((x, y)/z + κ U) / tanθ
//! ```
//!
//! which is the ray's own pixel unless the splat is painted. Unpainted, the picture is the mean of the decoded pinhole pictures; painted it stays
//! additive and conserves the light.

use super::aperture_points::aperture_points;
use super::backdrop::{Backdrop, EndLight, PlainBackdrop};
use super::pixel_box::cover_pixels;
use crate::view::{EyeRaster, Follow, GaussianView, Hit, LaneHits, RayGrid, TileRow, end_at};
use glam::{DVec2, DVec3, Vec3};
use lens::{FocusOffset, Picture};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// How many rays are traced.
#[derive(Clone, Debug, PartialEq)]
pub struct TruthOptions {
    /// Aperture points, at least 1.
    pub aperture_points: u32,
    /// Rays of a pixel's side for each of them, at least 1.
    pub rays_per_px: u32,
    /// Maximum pixels beyond the picture that are traced for what paint moves into it.
    pub max_margin_px: u32,
    /// Linear RGB radiance that all splats send in place of their own.
    pub uniform_radiance: Option<Vec3>,
}

impl Default for TruthOptions {
    /// 64 aperture points, 2 × 2 rays a pixel, up to 256 px of margin.
    fn default() -> Self {
        Self { aperture_points: 64, rays_per_px: 2, max_margin_px: 256, uniform_radiance: None }
    }
}

/// A picture of splats.
#[derive(Clone, Debug, PartialEq)]
pub struct GaussianPicture {
    /// Radiance and coverage; the background is in both.
    pub picture: Picture,
    /// The share of a pixel that splats send, as coverage counts it.
    pub alpha: Vec<f32>,
}

/// Renders a view through its camera's aperture. `focus` has the focus of each splat of the cloud; `None` is the ordinary lens.
///
/// # Errors
/// `progress` cancels.
///
/// # Panics
/// `focus` is not as long as the cloud.
pub fn render_truth(
    view: &GaussianView<'_>,
    focus: Option<&[FocusOffset]>,
    options: &TruthOptions,
    progress: &dyn Progress,
) -> Result<GaussianPicture, Cancelled> {
    render_truth_before(view, focus, &PlainBackdrop::of(view.camera()), options, progress)
}

/// The same before a backdrop: surfaces that end rays, and what shines through.
///
/// # Errors
/// `progress` cancels.
///
/// # Panics
/// `focus` is not as long as the cloud.
pub fn render_truth_before(
    view: &GaussianView<'_>,
    focus: Option<&[FocusOffset]>,
    backdrop: &dyn Backdrop,
    options: &TruthOptions,
    progress: &dyn Progress,
) -> Result<GaussianPicture, Cancelled> {
    assert!(focus.is_none_or(|focus| focus.len() == view.cloud().len()));
    let radius = view.optics().aperture_radius;
    let points = match radius > 0.0 {
        true => aperture_points(&view.camera().aperture, options.aperture_points.max(1)),
        false => vec![DVec2::ZERO],
    };
    let focus =
        focus.map(|focus| (0..view.len() as u32).map(|splat| focus[view.cloud_index(splat)]).collect());
    let points: Vec<DVec2> = points.into_iter().map(|u| u * radius).collect();
    Truth::new(view, focus, backdrop, options).render(&points, progress)
}

/// Renders a view through its aperture's centre, with `rays_per_px` × `rays_per_px` rays a pixel.
///
/// # Errors
/// `progress` cancels.
pub fn render_pinhole(
    view: &GaussianView<'_>,
    rays_per_px: u32,
    progress: &dyn Progress,
) -> Result<GaussianPicture, Cancelled> {
    let options = TruthOptions { rays_per_px, ..TruthOptions::default() };
    let backdrop = PlainBackdrop::of(view.camera());
    Truth::new(view, None, &backdrop, &options).render(&[DVec2::ZERO], progress)
}

/// Rows of tiles that are traced at once, whatever the number of threads: sums are added in their order.
const BATCH: u32 = 8;

/// What rays bring to a pixel.
#[derive(Clone, Copy, Default)]
struct Sum {
    radiance: DVec3,
    coverage: f64,
    alpha: f64,
}

impl Sum {
    /// A share of the light of a splat.
    #[inline]
    fn of_splat(radiance: Vec3, weight: f64) -> Self {
        Self { radiance: radiance.as_dvec3(), coverage: weight, alpha: weight }
    }

    fn scaled(self, share: f64) -> Self {
        let Self { radiance, coverage, alpha } = self;
        Self { radiance: radiance * share, coverage: coverage * share, alpha: alpha * share }
    }

    #[inline]
    fn add(&mut self, other: Self) {
        self.radiance += other.radiance;
        self.coverage += other.coverage;
        self.alpha += other.alpha;
    }
}

/// Sums of the rows of pixels that some rays reach.
type RowSums = BTreeMap<i64, Vec<Sum>>;

struct Truth<'v> {
    view: &'v GaussianView<'v>,
    /// The focus of each splat of the view, where any is painted.
    focus: Option<Vec<FocusOffset>>,
    grid: RayGrid,
    backdrop: &'v dyn Backdrop,
    uniform_radiance: Option<Vec3>,
    size: [u32; 2],
}

impl<'v> Truth<'v> {
    fn new(
        view: &'v GaussianView<'v>,
        focus: Option<Vec<FocusOffset>>,
        backdrop: &'v dyn Backdrop,
        options: &TruthOptions,
    ) -> Self {
        let camera = view.camera();
        let focus = focus.filter(|focus| focus.iter().any(|offset| !offset.is_standard()));
        let reach = focus.as_ref().map_or(0.0, |focus| painted_reach_px(view, focus));
        let margin = (reach.max(backdrop.painted_reach_px()).ceil() as u32).min(options.max_margin_px);
        let grid = RayGrid::new(camera.width, camera.height, margin, options.rays_per_px.max(1));
        let uniform_radiance = options.uniform_radiance;
        Self { view, focus, grid, backdrop, uniform_radiance, size: [camera.width, camera.height] }
    }

    fn render(&self, points: &[DVec2], progress: &dyn Progress) -> Result<GaussianPicture, Cancelled> {
        let [width, height] = self.size;
        let mut sums = vec![Sum::default(); width as usize * height as usize];
        let rows = self.grid.tile_rows();
        for (index, point) in points.iter().enumerate() {
            let raster = EyeRaster::new(self.view, *point, &self.grid);
            for first in (0..rows).step_by(BATCH as usize) {
                progress.check()?;
                progress.report((index as f32 + first as f32 / rows as f32) / points.len() as f32);
                let batch: Vec<RowSums> = (first..(first + BATCH).min(rows))
                    .into_par_iter()
                    .map(|row| self.trace(&raster, &raster.tile_row(row)))
                    .collect();
                for (row, values) in batch.into_iter().flatten() {
                    let start = row as usize * width as usize;
                    sums[start..].iter_mut().zip(values).for_each(|(sum, value)| sum.add(value));
                }
            }
        }
        let rays = f64::from(self.grid.rays_per_px).powi(2) * points.len() as f64;
        let mut picture = Picture::black(width, height);
        for (index, sum) in sums.iter().enumerate() {
            picture.radiance[index] = (sum.radiance / rays).as_vec3().to_array();
            picture.coverage[index] = (sum.coverage / rays) as f32;
        }
        Ok(GaussianPicture { picture, alpha: sums.iter().map(|sum| (sum.alpha / rays) as f32).collect() })
    }

    /// The light of the rays of a row of tiles.
    fn trace(&self, raster: &EyeRaster<'_>, tiles: &TileRow<'_>) -> RowSums {
        let (mut sums, mut lanes) = (RowSums::new(), LaneHits::default());
        let (mut pixels, mut directions) = (Vec::new(), Vec::new());
        tiles.for_each_tile(&raster.eye, |columns, tracer| {
            for row in tiles.rays.clone() {
                pixels.clear();
                pixels.extend(columns.clone().map(|column| self.grid.pixel(column, row)));
                directions.clear();
                directions.extend(pixels.iter().map(|pixel| self.view.direction(raster.eye.point(), *pixel)));
                tracer.trace(row, &directions, Follow::Visible, &mut lanes);
                for (pixel, (hits, rest)) in pixels.iter().zip(lanes.hits.iter_mut().zip(lanes.rest)) {
                    self.add_ray(raster, *pixel, hits, rest, &mut sums);
                }
            }
        });
        sums
    }

    /// Adds the light of a ray, of which `rest` passes all splats.
    fn add_ray(
        &self,
        raster: &EyeRaster<'_>,
        pixel: DVec2,
        hits: &mut Vec<Hit>,
        mut rest: f64,
        sums: &mut RowSums,
    ) {
        let u = raster.eye.point();
        let direction = self.view.direction(u, pixel);
        let end = self.backdrop.end(u, direction, pixel);
        if end.depth < f64::INFINITY {
            rest = end_at(hits, end.depth);
        }
        let light = raster.light(hits);
        // What no paint moves stays in the ray's own pixel.
        let mut own = Sum::default();
        let mut send = |sum: Sum, depth: f64, focus: FocusOffset| {
            if focus.is_standard() {
                return own.add(sum);
            }
            // q tanθ = q₀ tanθ + (κ − κ_standard) U: exact at infinity, too.
            let optics = self.view.optics();
            let moved = optics.kappa(1.0 / depth, focus) - optics.standard_kappa(1.0 / depth);
            let q = self.view.camera().q_from_pixel(pixel) + moved * u / optics.tan_half_yfov;
            self.add_box(self.view.camera().pixel_from_q(q), sum, sums);
        };
        for hit in &*hits {
            let sent = self.uniform_radiance.unwrap_or_else(|| raster.radiance(hit.splat) * light.gain);
            let radiance = hit.weight as f32 * sent;
            let focus = self.focus.as_ref().map_or(FocusOffset::STANDARD, |focus| focus[hit.splat as usize]);
            send(Sum::of_splat(radiance, hit.weight), hit.depth, focus);
        }
        for EndLight { radiance, share, focus } in end.light {
            let coverage = rest * share;
            let alpha = if end.depth < f64::INFINITY { coverage } else { 0.0 };
            send(Sum { radiance: radiance.as_dvec3() * rest, coverage, alpha }, end.depth, focus);
        }
        let [width, height] = self.size.map(f64::from);
        if pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x < width && pixel.y < height {
            let row = sums.entry(pixel.y as i64).or_insert_with(|| self.empty_row());
            row[pixel.x as usize].add(own);
        }
    }

    /// Adds light that lands about `center` (px): a ray is as wide as the grid is fine.
    fn add_box(&self, center: DVec2, sum: Sum, sums: &mut RowSums) {
        let [width, height] = self.size.map(i64::from);
        let side = 1.0 / f64::from(self.grid.rays_per_px);
        cover_pixels(center, side, 0..width, 0..height, |column, row, share| {
            let sums = sums.entry(row).or_insert_with(|| self.empty_row());
            sums[column as usize].add(sum.scaled(share));
        });
    }

    fn empty_row(&self) -> Vec<Sum> {
        vec![Sum::default(); self.size[0] as usize]
    }
}

/// How far paint moves light, px: max |κ − κ_standard| R / tanθ over the splats, taken at their means.
fn painted_reach_px(view: &GaussianView<'_>, focus: &[FocusOffset]) -> f64 {
    let optics = view.optics();
    let reach = |splat: usize| {
        let inverse_depth = 1.0 / view.mean_depth(splat as u32);
        let moved = optics.kappa(inverse_depth, focus[splat]) - optics.standard_kappa(inverse_depth);
        optics.splat_radius_px(moved).abs()
    };
    let painted = (0..focus.len()).filter(|splat| !focus[*splat].is_standard());
    // A ray's width, and what a splat's own depth adds.
    painted.map(reach).fold(0.0, f64::max) + 2.0
}
