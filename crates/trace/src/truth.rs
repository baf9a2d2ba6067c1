//! The ground truth: the focus model, ray by ray.
//!
//! Two independent estimators of the same integral ([`Estimator`]), which must agree: rays that start at the
//! sensor and are sent back to it by what they hit (`from_sensor`), and rays that start at the surfaces
//! (`from_surfaces`). They share the optics, the tracer and the radiance, with each other and with the splat,
//! and nothing else.
//!
//! A render is a row of passes ([`Truth::pass`]), each a picture of its own of a few samples a pixel. Within a
//! pass sums are integers, so that any order and any number of threads gives the same bits (`sensor`); from
//! pass to pass means and scatter are kept, and the scatter gives the standard error of every pixel
//! ([`Estimate`]). Samples are low-discrepancy points that go on from pass to pass (`samples`), spread evenly where
//! a pixel's edges and texture are decided (`sheared`, `survey`). Which surfaces may send light into the picture at
//! all, and from how far outside the frame, follows from bounds on κ over pieces of surface (`kappa_bounds`,
//! `patches`, `reach`).

mod bright_surfaces;
mod estimate;
mod filter;
mod from_sensor;
mod from_surfaces;
mod kappa_bounds;
mod options;
mod patches;
mod ray_focus;
mod reach;
mod samples;
mod sensor;
mod sheared;
mod survey;
mod view;

pub use estimate::Estimate;
pub use filter::ReconstructionFilter;
pub use options::{Estimator, Region, Sampler, TruthOptions};
pub use ray_focus::{RayFocus, RayOptics};

use crate::{Radiance, Tracer};
use estimate::Statistics;
use from_sensor::FromSensor;
use from_surfaces::FromSurfaces;
use glam::DVec2;
use lens::{Camera, FocusOffset, Vignetting};
use progress::{Cancelled, Progress, Stage};
use scene::SurfaceField;
use sensor::Sensor;
use view::View;

/// A render in progress.
pub struct Truth<'a> {
    view: View<'a>,
    radiance: &'a dyn Radiance,
    options: TruthOptions,
    region: Region,
    sensor: Sensor,
    vignetting: Option<Vignetting>,
    statistics: Statistics,
    /// Made by the first pass.
    rays: Option<Rays>,
}

/// Where rays start.
enum Rays {
    Sensor(Box<FromSensor>),
    Surfaces(FromSurfaces),
}

/// Renders `camera`'s picture of the scene in `tracer`, focused by `focus`: all passes.
///
/// The camera must be valid. The picture is conserved radiance with its coverage, of the options' region; the
/// same bits for any number of threads.
///
/// # Errors
/// [`Cancelled`] if `progress` is cancelled.
pub fn render(
    tracer: &Tracer,
    radiance: &dyn Radiance,
    focus: &dyn SurfaceField<FocusOffset>,
    camera: &Camera,
    options: &TruthOptions,
    progress: &dyn Progress,
) -> Result<Estimate, Cancelled> {
    let mut truth = Truth::new(tracer, radiance, focus, camera, options);
    while !truth.is_done() {
        let done = |samples: u32| samples as f32 / options.samples_per_pixel.max(1) as f32;
        let [before, after] = [truth.samples_per_pixel(), truth.next_pass().end].map(done);
        truth.pass(&Stage::new(progress, before, after))?;
    }
    Ok(truth.estimate())
}

impl<'a> Truth<'a> {
    /// Prepares to render `camera`'s picture by rays, or the region of it in `options`: light from `radiance`,
    /// focused by `focus`. See [`render`].
    pub fn new(
        tracer: &'a Tracer,
        radiance: &'a dyn Radiance,
        focus: &'a dyn SurfaceField<FocusOffset>,
        camera: &'a Camera,
        options: &TruthOptions,
    ) -> Self {
        let region = options.region.unwrap_or_else(|| Region::frame(camera)).within(camera);
        let view = View::new(tracer, focus, camera);
        let has_fringe = camera.character.has_fringe();
        Self {
            view,
            vignetting: camera.vignetting(),
            radiance,
            options: *options,
            region,
            sensor: Sensor::new(region, options.filter, options.samples_of_pass(), has_fringe),
            statistics: Statistics::new(region.width, region.height),
            rays: None,
        }
    }

    /// Focuses ray by ray by `ray_focus`, in place of the painted focus. To be set before the first pass.
    pub fn with_ray_focus(self, ray_focus: &'a dyn RayFocus) -> Self {
        Self { view: View { ray_focus: Some(ray_focus), ..self.view }, ..self }
    }

    /// The pixels that it renders: the options' region, as far as it lies in the frame.
    pub fn region(&self) -> Region {
        self.region
    }

    /// Samples a pixel so far, by all passes.
    pub fn samples_per_pixel(&self) -> u32 {
        self.statistics.samples
    }

    /// Whether it has as many samples as the options request. Further passes may still be added.
    pub fn is_done(&self) -> bool {
        self.samples_per_pixel() >= self.options.samples_per_pixel.max(1)
    }

    /// Which samples of a pixel the next pass takes.
    fn next_pass(&self) -> std::ops::Range<u32> {
        let (first, pass) = (self.samples_per_pixel(), self.options.samples_of_pass());
        let total = self.options.samples_per_pixel.max(1);
        let last = first.saturating_add(pass);
        first..if first < total { last.min(total) } else { last }
    }

    /// Adds a pass of [`TruthOptions::samples_of_pass`] samples a pixel (or as few as are left to do). If it is
    /// cancelled, the estimate stays as it was before.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn pass(&mut self, progress: &dyn Progress) -> Result<(), Cancelled> {
        progress.check()?;
        let retained = self.rays.take();
        let Self { view, radiance, options, sensor, .. } = &*self;
        let rays = retained.unwrap_or_else(|| match options.estimator {
            Estimator::Sensor => Rays::Sensor(Box::new(FromSensor::new(view, *radiance, sensor, options))),
            Estimator::Surface => Rays::Surfaces(FromSurfaces::new(view, *radiance, sensor, options)),
        });
        let passed = self.next_pass();
        let samples = passed.end - passed.start;
        let exposed = loop {
            self.sensor.clear();
            let (view, sensor, passed) = (&self.view, &self.sensor, passed.clone());
            let exposed = match &rays {
                Rays::Sensor(rays) => rays.expose(view, self.radiance, sensor, passed, progress),
                Rays::Surfaces(rays) => rays.expose(view, self.radiance, sensor, passed, progress),
            };
            // Brighter than the integers were made for: once more with coarser ones.
            if exposed.is_err() || !self.sensor.coarsen_if_overflowed() {
                break exposed;
            }
        };
        self.rays = Some(rays);
        exposed?;
        self.statistics.add(samples, self.sensor.means(samples));
        if let Some(coverage) = self.sensor.colour_means(samples) {
            self.statistics.add_colours(samples, self.sensor.means(samples), coverage);
        }
        Ok(())
    }

    /// The picture so far, with its standard error.
    pub fn estimate(&self) -> Estimate {
        let (estimate, region, camera) = (self.statistics.estimate(), self.region, self.view.camera);
        let Some(vignetting) = &self.vignetting else { return estimate };
        estimate.darkened(|pixel| {
            let (x, y) = (pixel % region.width as usize, pixel / region.width as usize);
            let corner = DVec2::new(f64::from(region.x), f64::from(region.y));
            vignetting.at(camera.q_from_pixel(corner + DVec2::new(x as f64, y as f64) + 0.5))
        })
    }
}

#[cfg(test)]
mod tests;
