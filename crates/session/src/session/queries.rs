//! Queries of a session.

use crate::blur_histogram::BlurHistogram;
use crate::light_field::ApertureImage;
use crate::session::state::Session;
use document::{SurfaceHit, chief_ray, pick};
use glam::DVec2;
use lens::FocusOffset;
use rayon::prelude::*;
use trace::Ray;

impl Session {
    /// The first surface that a ray of either view hits; `None` if there is none.
    pub fn pick(&self, ray: &Ray) -> Option<SurfaceHit> {
        pick(self.document.as_ref()?.stage.tracer(), ray)
    }

    /// The ray of a position in the picture: (0, 0) its upper left corner, (1, 1) its lower right.
    pub fn picture_ray(&self, position: DVec2) -> Option<Ray> {
        Some(chief_ray(&self.document.as_ref()?.camera, position))
    }

    /// Axial depths, scene units, at a grid of [columns, rows] points from corner to corner of the picture, row by row; infinite where there is
    /// no surface. `None` if nothing is open.
    pub fn depth_grid(&self, [columns, rows]: [usize; 2]) -> Option<Vec<f64>> {
        let document = self.document.as_ref()?;
        let (tracer, camera) = (document.stage.tracer(), &document.camera);
        let last = DVec2::new((columns - 1).max(1) as f64, (rows - 1).max(1) as f64);
        let depth = |index: usize| {
            let position = DVec2::new((index % columns) as f64, (index / columns) as f64) / last;
            let hit = pick(tracer, &chief_ray(camera, position));
            hit.map_or(f64::INFINITY, |hit| camera.camera_from_world(hit.position).z)
        };
        Some((0..columns * rows).into_par_iter().map(depth).collect())
    }

    /// The focus at a surface point; `None` if nothing is open.
    pub fn focus_at(&self, hit: &SurfaceHit) -> Option<FocusOffset> {
        Some(self.document.as_ref()?.focus_at(hit))
    }

    /// The aperture as seen from a surface point. `None` if nothing is open, the aperture is a pinhole, or the point is behind it.
    pub fn aperture_image(&self, hit: &SurfaceHit) -> Option<ApertureImage> {
        ApertureImage::trace_at(self.document()?, self.light_field.as_ref(), hit)
    }

    /// Number of light fields that the preview has had: [`Self::aperture_image`] may change with a new one.
    pub fn light_field_count(&self) -> u64 {
        self.light_field_count
    }

    /// Circles of confusion at a grid of [columns, rows] positions of the picture, by chief rays. `None` if nothing is open.
    pub fn blur_histogram(&self, grid: [usize; 2]) -> Option<BlurHistogram> {
        Some(BlurHistogram::measure(self.document()?, grid))
    }
}
