//! The ground truth: distributed ray tracing of the focus model.
//!
//! Every pixel of the frame and of a guard band around it sends rays through the aperture toward the focus
//! plane, as any thin-lens camera does (Cook, Porter and Carpenter 1984). What a ray hits is then sent on to
//! the sensor with the hit's own defocus κ: it lands not where it came from but
//!
//! ```text
//! p + (κ − κ_standard)·U/tanθ
//! ```
//!
//! away, p the position it left the picture at (half-heights), U its aperture point, and adds its radiance to
//! the pixel it lands in, 1/spp of it. The change of variables has no Jacobian of its own (p at fixed U moves
//! with the surface), so energy is conserved, and a standard hit keeps its pixel exactly.
//!
//! It shares the optics with the splat and nothing else. Sums are integers, so that any order and any number
//! of threads gives the same bits (`sensor`); samples are the same low-discrepancy points in every pixel
//! (`pixel_samples`); the guard band is as wide as probing rays say (`guard_band`). Small bright surfaces
//! also send rays of their own (`bright_surfaces`).

mod bright_surfaces;
mod guard_band;
mod pixel_samples;
mod sample_ray;
mod sensor;

use crate::{Radiance, Tracer};
use bright_surfaces::BrightSurfaces;
use glam::{DVec2, Vec3};
use lens::{Camera, FocusOffset, Picture};
use pixel_samples::PixelSample;
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;
use sample_ray::SampleRays;
use scene::SurfaceField;
use sensor::{Quantiser, Sensor};
use std::sync::atomic::{AtomicUsize, Ordering};

/// How the ground truth is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TruthOptions {
    /// Rays a pixel of the frame and of its guard band; 0 counts as 1.
    pub samples_per_pixel: u32,
    /// Seed of the scramble.
    pub seed: u32,
}

impl Default for TruthOptions {
    fn default() -> Self {
        Self { samples_per_pixel: 256, seed: 0 }
    }
}

/// The side of a tile, px: the unit of work.
const TILE_PX: i64 = 16;

/// Renders `camera`'s picture of the scene in `tracer`, focused by `focus`.
///
/// The camera must be valid. The picture is conserved radiance with its coverage; both are exact sums of the
/// samples, the same for any number of threads.
pub fn render(
    tracer: &Tracer,
    radiance: &dyn Radiance,
    focus: &dyn SurfaceField<FocusOffset>,
    camera: &Camera,
    options: &TruthOptions,
    progress: &dyn Progress,
) -> Result<Picture, Cancelled> {
    let rays = SampleRays::new(tracer, focus, camera);
    let guard_px = guard_band::width_px(&rays, progress)?;
    let samples = options.samples_per_pixel.max(1);
    let bright = BrightSurfaces::find(&rays, radiance, samples, guard_px);
    let mut quantiser = Quantiser::for_samples(samples);
    loop {
        let sensor = Sensor::new(camera, quantiser);
        let batches = pixel_samples::batches(camera, samples, options.seed);
        let own_rays = if bright.is_empty() { 0.0 } else { 0.1 };
        bright.shine(&rays, radiance, &sensor, options.seed, &Stage::new(progress, 0.0, own_rays))?;
        let share = (1.0 - own_rays) / batches.len() as f32;
        for (k, batch) in batches.enumerate() {
            let start = own_rays + share * k as f32;
            let exposure =
                Exposure { rays: &rays, radiance, bright: &bright, sensor: &sensor, samples: &batch };
            exposure.expose(guard_px, &Stage::new(progress, start, start + share))?;
        }
        match sensor.develop(samples) {
            Some(picture) => return Ok(picture),
            // Brighter than the integers were made for: once more with coarser ones.
            None => quantiser = quantiser.coarser(),
        }
    }
}

/// One exposure of a sensor to a batch of samples of each pixel.
struct Exposure<'a> {
    rays: &'a SampleRays<'a>,
    radiance: &'a dyn Radiance,
    bright: &'a BrightSurfaces,
    sensor: &'a Sensor,
    samples: &'a [PixelSample],
}

impl Exposure<'_> {
    /// Sends the rays of the frame and of `guard_px` pixels around it.
    fn expose(&self, guard_px: i64, progress: &dyn Progress) -> Result<(), Cancelled> {
        let (width, height) = self.sensor.size();
        let tiles_of = |length: i64| (length + 2 * guard_px + TILE_PX - 1) / TILE_PX;
        let (columns, rows) = (tiles_of(width), tiles_of(height));
        let done = AtomicUsize::new(0);
        (0..columns * rows).into_par_iter().try_for_each(|tile| {
            let (left, top) = (tile % columns * TILE_PX - guard_px, tile / columns * TILE_PX - guard_px);
            for y in top..(top + TILE_PX).min(height + guard_px) {
                progress.check()?;
                for x in left..(left + TILE_PX).min(width + guard_px) {
                    self.expose_pixel(x, y);
                }
            }
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress.report(done as f32 / (columns * rows) as f32);
            Ok(())
        })
    }

    /// Sends the rays of one pixel; (0, 0) is the frame's upper left one.
    fn expose_pixel(&self, x: i64, y: i64) {
        let corner = DVec2::new(x as f64, y as f64);
        let own = self.sensor.pixel(corner);
        // What stays in this pixel is summed here first.
        let mut stays = sensor::Sum::default();
        for sample in self.samples {
            let from = corner + sample.within_px;
            let found = self.rays.trace(from, sample.u);
            let Some(pixel) = self.sensor.pixel(from + found.displacement_px) else { continue };
            let light = self.sensor.quantise(self.light(&found, sample.u));
            if Some(pixel) == own {
                stays.add(light);
            } else {
                self.sensor.add(pixel, sensor::Sum::of(light));
            }
        }
        if let Some(pixel) = own {
            self.sensor.add(pixel, stays);
        }
    }

    /// The radiance that a sample through the aperture point `u` carries.
    fn light(&self, sample: &sample_ray::Sample, u: DVec2) -> Vec3 {
        match sample.point {
            Some(point) => {
                let share = self.bright.camera_share(self.rays, point, u);
                self.radiance.toward(point, sample.eye) * share as f32
            }
            None => self.radiance.from_infinity(sample.direction),
        }
    }
}

#[cfg(test)]
mod tests;
