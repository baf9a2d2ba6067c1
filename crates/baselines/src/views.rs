//! Shift and add: a sparse light field of pinhole views over the aperture, refocused.
//!
//! The aperture's square is cut to m × m cells, and a pinhole view is traced from the middle of each open one: what a
//! plenoptic camera or an array of cameras captures. To focus at s, the view from U is shifted by U/s and all are added
//! (Ng et al., "Light Field Photography with a Hand-held Plenoptic Camera", 2005): a point of depth z then lands at
//!
//! ```text
//! q = ((x, y)/z − U/z + U/s)/tanθ = ((x, y)/z + κU)/tanθ,     κ = 1/s − 1/z
//! ```
//!
//! where the thin lens sends it, but for m² aperture points only. Out of focus, neighbouring copies of a point part: it
//! ghosts (see [`crate::ghosting_bounds`]).
//!
//! **Paint.** A shift is one number a view. To focus points apart, every pixel of a view needs its own,
//!
//! ```text
//! shift = (κ + 1/z)·U/tanθ
//! ```
//!
//! with the point's painted κ and its depth: geometry, which a light field does not have. Here the tracer gives it, so that
//! painted pictures can be compared at all: every pixel goes where the model sends its ray, and what is left of the error is
//! that of few views. Where no paint is, the shift is the plain U/s.
//!
//! Views are pictures of pixels: a pixel's light, the mean of some rays through it, is laid down as a whole pixel, shared
//! bilinearly among the four that it overlaps. A view sees the frame as the unpainted focus will use it; light that paint
//! would bring in from farther outside is not captured.

use crate::BaselineError;
use crate::aperture_grid::{ApertureCell, open_cells};
use crate::bands::{Band, PictureSum};
use crate::error::check_option;
use glam::DVec2;
use lens::{Camera, FocusOffset, Optics, Picture};
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;
use scene::SurfaceField;
use std::ops::{Range, RangeInclusive};
use std::sync::atomic::{AtomicU32, Ordering};
use trace::{Radiance, Ray, Tracer};

/// The views a side that are accepted.
pub(crate) const VIEWS_A_SIDE: RangeInclusive<u32> = 1..=64;

/// What is captured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ViewsOptions {
    /// Views a side of the aperture's square, 1 to 64.
    pub views_a_side: u32,
    /// Rays through each pixel of a view, 1 to 256: filters the views.
    pub rays_a_pixel: u32,
}

impl Default for ViewsOptions {
    fn default() -> Self {
        Self { views_a_side: 5, rays_a_pixel: 4 }
    }
}

/// Traces the views of `camera`'s aperture and adds them, focused by `focus`. Coverage is the sum of the shifted pixels: 1
/// everywhere without paint.
///
/// # Errors
/// [`BaselineError`] if an option is out of range, or `progress` is cancelled.
pub fn shift_and_add(
    tracer: &Tracer,
    radiance: &dyn Radiance,
    focus: &dyn SurfaceField<FocusOffset>,
    camera: &Camera,
    options: &ViewsOptions,
    progress: &dyn Progress,
) -> Result<Picture, BaselineError> {
    camera.validate()?;
    check_option("views a side", options.views_a_side, VIEWS_A_SIDE, "1 to 64")?;
    check_option("rays a pixel", options.rays_a_pixel, 1..=256, "1 to 256")?;
    let cells = open_cells(&camera.aperture, options.views_a_side)?;
    let mut sum = PictureSum::new([camera.width, camera.height]);
    for (index, cell) in cells.iter().enumerate() {
        let of_all = |k: usize| k as f32 / cells.len() as f32;
        let stage = Stage::new(progress, of_all(index), of_all(index + 1));
        let view = View::new(camera, cell, index as u32, options.rays_a_pixel);
        let rows = view.capture(tracer, radiance, focus, &Stage::new(&stage, 0.0, 0.9))?;
        let deposit = |_: usize, row: &ViewRow, band: &mut Band| row.deposit(cell.share, band);
        sum.add(&rows, ViewRow::lands_in, deposit, &Stage::new(&stage, 0.9, 1.0))?;
    }
    Ok(sum.into_picture())
}

/// A pinhole view from one aperture point.
struct View<'a> {
    camera: &'a Camera,
    optics: Optics,
    /// The aperture point U, scene units.
    u: DVec2,
    /// How far the unpainted focus shifts it, px (x right, y down).
    shift_px: DVec2,
    /// Which of the views it is.
    index: u32,
    rays_a_pixel: u32,
}

/// One row of a view's pixels, where they land.
#[derive(Default)]
struct ViewRow {
    pixels: Vec<LandedPixel>,
}

/// A view's pixel, or a painted part of it.
struct LandedPixel {
    /// Its upper left corner on the picture, px.
    corner: DVec2,
    /// Radiance and coverage.
    light: [f64; 4],
}

impl<'a> View<'a> {
    fn new(camera: &'a Camera, cell: &ApertureCell, index: u32, rays_a_pixel: u32) -> Self {
        let optics = camera.optics();
        let u = cell.u * camera.aperture_radius;
        let mut view = Self { camera, optics, u, shift_px: DVec2::ZERO, index, rays_a_pixel };
        view.shift_px = view.shift_px(optics.inverse_focus_distance);
        view
    }

    /// U times `factor` (1/length) on the picture, px.
    fn shift_px(&self, factor: f64) -> DVec2 {
        let shift = factor * self.u / self.optics.tan_half_yfov * self.optics.half_height_px;
        DVec2::new(shift.x, -shift.y)
    }

    /// Traces the pixels that the unpainted focus needs: the frame, shifted back, and one more where that is no whole
    /// number of pixels.
    fn capture(
        &self,
        tracer: &Tracer,
        radiance: &dyn Radiance,
        focus: &dyn SurfaceField<FocusOffset>,
        progress: &dyn Progress,
    ) -> Result<Vec<ViewRow>, Cancelled> {
        let corner = (-self.shift_px).floor();
        let done = AtomicU32::new(0);
        (0..=self.camera.height)
            .into_par_iter()
            .map(|y| {
                progress.check()?;
                let mut row = ViewRow::default();
                for x in 0..=self.camera.width {
                    self.capture_pixel(tracer, radiance, focus, corner, [x, y], &mut row);
                }
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                progress.report(done as f32 / (self.camera.height + 1) as f32);
                Ok(row)
            })
            .collect()
    }

    /// Traces the pixel `[x, y]` of the view, whose upper left corner is at `origin` px.
    fn capture_pixel(
        &self,
        tracer: &Tracer,
        radiance: &dyn Radiance,
        focus: &dyn SurfaceField<FocusOffset>,
        origin: DVec2,
        [x, y]: [u32; 2],
        row: &mut ViewRow,
    ) {
        let corner = origin + DVec2::new(f64::from(x), f64::from(y));
        let share = 1.0 / f64::from(self.rays_a_pixel);
        let seed = scramble([self.index, x, y]);
        let mut unpainted = [0.0; 4];
        for index in 0..self.rays_a_pixel {
            // Apart in every pixel: a grid would round all edges of a view in the same direction.
            let within = [0, 1].map(|axis| f64::from(sobol_burley::sample(index, axis, seed)));
            let ray = Ray::pinhole(self.camera, self.u, corner + DVec2::from_array(within));
            let hit = tracer.first_hit(&ray);
            let (rgb, offset) = match &hit {
                Some(hit) => (radiance.total_outgoing(hit.point, ray.origin), focus.at(hit.point)),
                None => (radiance.environment(ray.direction), focus.at_infinity()),
            };
            let [r, g, b] = rgb.to_array().map(|c| f64::from(c) * share);
            let light = [r, g, b, share];
            let offset = offset.or_standard();
            if offset.is_standard() {
                (0..4).for_each(|c| unpainted[c] += light[c]);
            } else {
                let inverse_depth = hit.map_or(0.0, |hit| 1.0 / hit.t);
                let factor = self.optics.kappa(inverse_depth, offset) + inverse_depth;
                row.push(corner + self.shift_px(factor), light);
            }
        }
        if unpainted[3] > 0.0 {
            row.push(corner + self.shift_px, unpainted);
        }
    }
}

/// A seed of its own for every pixel of every view (hash of "Hash functions for GPU rendering", Jarzynski and Olano 2020:
/// pcg, nested).
fn scramble(words: [u32; 3]) -> u32 {
    words.into_iter().fold(0, |hash: u32, word| {
        let state = hash.wrapping_add(word).wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    })
}

impl ViewRow {
    fn push(&mut self, corner: DVec2, light: [f64; 4]) {
        self.pixels.push(LandedPixel { corner, light });
    }

    /// The picture's rows that it may touch.
    fn lands_in(&self) -> Range<i64> {
        let rows = || self.pixels.iter().map(|pixel| pixel.corner.y.floor() as i64);
        match (rows().min(), rows().max()) {
            (Some(first), Some(last)) => first..last.saturating_add(2),
            _ => 0..0,
        }
    }

    /// Lays the pixels down, `share` of each.
    fn deposit(&self, share: f64, band: &mut Band) {
        for LandedPixel { corner, light } in &self.pixels {
            let first = corner.floor();
            let rest = corner - first;
            let (x, y) = (first.x as i64, first.y as i64);
            for (row, height) in [(y, 1.0 - rest.y), (y.saturating_add(1), rest.y)] {
                for (column, width) in [(x, 1.0 - rest.x), (x.saturating_add(1), rest.x)] {
                    band.add(column, row, light.map(|c| c * (share * width * height)));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
