//! The first surface of each pixel of a coarse grid: how far it is, and how it is painted.

use crate::picture::blur_scale;
use glam::DVec2;
use lens::{Camera, FocusOffset, Optics};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::SurfaceField;
use trace::{Ray, Tracer};
use web_page::{DistanceRange, PaintMaps, PixelMap, paint_code};

/// Pixels of the picture per pixel of the grid, along each side.
const PIXELS_A_SIDE: u32 = 2;
/// The longest side of the grid.
const LONGEST_SIDE: u32 = 1024;

/// What the chief rays of a grid of pixels meet first, row by row from the top.
pub struct FirstSurfaces {
    size: [u32; 2],
    /// 1/z, 1/length; 0 where there is no surface.
    inverse_depths: Vec<f64>,
    focus: Vec<FocusOffset>,
}

impl FirstSurfaces {
    /// Traces the rays.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn trace(
        tracer: &Tracer,
        camera: &Camera,
        focus: &dyn SurfaceField<FocusOffset>,
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let longest = camera.width.max(camera.height);
        let pixels_a_side = longest.div_ceil(LONGEST_SIDE).max(PIXELS_A_SIDE);
        let size = [camera.width, camera.height].map(|side| side.div_ceil(pixels_a_side));
        let pixels_per_cell = DVec2::new(camera.width.into(), camera.height.into())
            / DVec2::new(size[0].into(), size[1].into());
        let surface = |cell: u64| {
            let [x, y] = [cell % u64::from(size[0]), cell / u64::from(size[0])];
            let pixel = (DVec2::new(x as f64, y as f64) + 0.5) * pixels_per_cell;
            match tracer.first_hit(&Ray::pinhole(camera, DVec2::ZERO, pixel)) {
                Some(hit) => (1.0 / hit.t, focus.at(hit.point).or_standard()),
                None => (0.0, focus.at_infinity().or_standard()),
            }
        };
        let rows = (0..u64::from(size[1])).into_par_iter().map(|row| {
            progress.check()?;
            let columns = u64::from(size[0]);
            Ok((row * columns..(row + 1) * columns).map(surface).collect::<Vec<_>>())
        });
        let rows = rows.collect::<Result<Vec<_>, Cancelled>>()?;
        let (inverse_depths, focus) = rows.into_iter().flatten().unzip();
        Ok(Self { size, inverse_depths, focus })
    }

    /// The distances that make some surface sharp for the ordinary lens, and that of the camera.
    pub fn range(&self, camera: &Camera) -> DistanceRange {
        let opening = camera.optics().inverse_focus_distance;
        let all = || self.inverse_depths.iter().copied();
        DistanceRange { farthest: all().fold(opening, f64::min), nearest: all().fold(opening, f64::max) }
    }

    /// Whether any of the surfaces is not focused by the ordinary lens.
    pub fn is_painted(&self) -> bool {
        !self.focus.iter().all(|focus| focus.is_standard())
    }

    /// Codes of the distances that make the surfaces sharp for the ordinary lens.
    pub fn sharp_distances(&self, range: DistanceRange) -> PixelMap {
        let codes = self.inverse_depths.iter().map(|&inverse| range.code(Some(inverse)));
        PixelMap { size: self.size, codes: codes.collect() }
    }

    /// Codes of the distances that make them sharp as painted, and of the paint.
    pub fn paint_maps(&self, range: DistanceRange, optics: &Optics) -> PaintMaps {
        let map = |code: &dyn Fn(f64, FocusOffset) -> u8| {
            let surfaces = self.inverse_depths.iter().zip(&self.focus);
            PixelMap {
                size: self.size,
                codes: surfaces.map(|(&inverse, &focus)| code(inverse, focus)).collect(),
            }
        };
        PaintMaps {
            sharp_distances: map(&|inverse_depth, focus| {
                range.code(optics.sharp_inverse_focus_distance(inverse_depth, focus))
            }),
            paint: map(&|_, focus| {
                // What the paint adds to the defocus at the anchor.
                let circle_px = 2.0 * optics.splat_radius_px((focus.t - 1.0) / optics.image_distance);
                paint_code((!focus.is_standard()).then(|| blur_scale::position(circle_px)))
            }),
        }
    }
}
