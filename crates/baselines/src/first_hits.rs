//! The pinhole picture: first hits along the chief rays of the pixel centres, with depth and focus.

use glam::DVec2;
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::SurfaceField;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};
use trace::{Radiance, Ray, Tracer};

/// One value a pixel, row 0 on top, of what the chief ray of the pixel's centre meets first.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstHits {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear RGB radiance toward the aperture's centre.
    pub radiance: Vec<[f32; 3]>,
    /// Axial depth in scene units; infinite where no surface is.
    pub depth: Vec<f32>,
    /// The focus of the point.
    pub focus: Vec<FocusOffset>,
    /// Its defocus κ, 1/length.
    pub kappa: Vec<f64>,
}

impl FirstHits {
    /// Traces one ray a pixel.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn trace(
        tracer: &Tracer,
        radiance: &dyn Radiance,
        focus: &dyn SurfaceField<FocusOffset>,
        camera: &Camera,
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let whole = [0..camera.width, 0..camera.height];
        Self::trace_part(tracer, radiance, focus, camera, whole, progress)
    }

    /// The same for some columns and rows of the camera's picture.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn trace_part(
        tracer: &Tracer,
        radiance: &dyn Radiance,
        focus: &dyn SurfaceField<FocusOffset>,
        camera: &Camera,
        [columns, rows_of_camera]: [Range<u32>; 2],
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let optics = camera.optics();
        let done = AtomicU32::new(0);
        let [width, height] = [columns.len() as u32, rows_of_camera.len() as u32];
        let corner = DVec2::new(columns.start.into(), rows_of_camera.start.into());
        let mut hits = Self::background(width, height);
        let row_length = width as usize;
        let rows = hits
            .radiance
            .par_chunks_mut(row_length)
            .zip(hits.depth.par_chunks_mut(row_length))
            .zip(hits.focus.par_chunks_mut(row_length))
            .zip(hits.kappa.par_chunks_mut(row_length));
        rows.enumerate().try_for_each(|(y, (((radiances, depths), offsets), kappas))| {
            progress.check()?;
            for x in 0..row_length {
                let pixel = corner + DVec2::new(x as f64, y as f64) + 0.5;
                let ray = Ray::pinhole(camera, DVec2::ZERO, pixel);
                let (rgb, depth, offset) = match tracer.visible_surface(&ray) {
                    Some(hit) => (radiance.total_outgoing(hit.point, ray.origin), hit.t, focus.at(hit.point)),
                    None => (radiance.environment(ray.direction), f64::INFINITY, focus.at_infinity()),
                };
                radiances[x] = rgb.to_array();
                depths[x] = depth as f32;
                let offset = offset.or_standard();
                offsets[x] = offset;
                kappas[x] = optics.kappa(1.0 / depth, offset);
            }
            progress.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / height as f32);
            Ok(())
        })?;
        Ok(hits)
    }

    /// Black, infinitely far and in focus everywhere.
    pub fn background(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self {
            width,
            height,
            radiance: vec![[0.0; 3]; pixels],
            depth: vec![f32::INFINITY; pixels],
            focus: vec![FocusOffset::STANDARD; pixels],
            kappa: vec![0.0; pixels],
        }
    }

    /// The picture of a pinhole: everything sharp.
    pub fn picture(&self) -> Picture {
        let coverage = vec![1.0; self.radiance.len()];
        Picture {
            width: self.width,
            height: self.height,
            radiance: self.radiance.clone(),
            coverage,
            colour_coverage: None,
        }
    }

    /// Signed diameter of the circle of confusion, px: negative in near defocus.
    pub fn circle_of_confusion_px(&self, camera: &Camera) -> Vec<f32> {
        let optics = camera.optics();
        self.kappa.iter().map(|&kappa| 2.0 * optics.splat_radius_px(kappa) as f32).collect()
    }
}
