//! Naive scattering: every ray of the light field is added to the single pixel that it lands in.
//!
//! A ray of the SALF goes from a point of a sample's footprint through a point of the aperture that is visible from the sample. Of
//! each sample, N rays are drawn (low-discrepancy points over footprint and aperture, by its share of open area), and each
//! carries 1/N of what the sample sends there,
//!
//! ```text
//! L·w(u)/N   to the pixel of   center + footprint + r·(u, −v),     r the radius of the aperture's image, px
//! ```
//!
//! It is the definition of the picture with nothing merged, cut or shared: unbiased for the light field that it is given,
//! noisy, and the speed that any splat has to beat.

use crate::BaselineError;
use crate::bands::{Band, PictureSum};
use crate::error::{check_option, check_size};
use glam::DVec2;
use lens::{ApertureSampler, Camera, FocusOffset, Picture};
use progress::Progress;
use rayon::prelude::*;
use salf::{Salf, Sample, SampleFocus, Visibility};
use scene::SurfaceField;
use std::ops::Range;

/// Sets of rays that samples choose from by their index: so many that neighbours seldom share one.
const RAY_SETS: usize = 64;

/// The number of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScatterOptions {
    /// Rays a sample, 1 to 65,536.
    pub rays_a_sample: u32,
    /// Seed of their scramble.
    pub seed: u32,
}

impl Default for ScatterOptions {
    /// As many rays as the finest visibility has cells.
    fn default() -> Self {
        Self { rays_a_sample: 256, seed: 0 }
    }
}

/// A ray of any sample.
#[derive(Clone, Copy)]
struct SampleRay {
    /// Where it starts on the footprint, in [−1, 1)².
    start: DVec2,
    /// Where it crosses the aperture, in units of the lens's radius.
    u: DVec2,
}

/// Throws the rays of `salf`. `camera` may differ from the baked one in focus distance, aperture shape and a smaller
/// aperture radius, nothing else.
///
/// # Errors
/// [`BaselineError`] if `salf` belongs to another camera, an option is out of range, or `progress` is cancelled.
pub fn scatter_rays(
    salf: &Salf,
    camera: &Camera,
    focus: &dyn SurfaceField<FocusOffset>,
    options: &ScatterOptions,
    progress: &dyn Progress,
) -> Result<Picture, BaselineError> {
    camera.validate()?;
    check_size([salf.camera.width, salf.camera.height], camera)?;
    check_option("rays a sample", options.rays_a_sample, 1..=1 << 16, "1 to 65536")?;
    let (optics, baked_radius) = (camera.optics(), salf.camera.aperture_radius);
    if optics.aperture_radius > baked_radius {
        return Err(BaselineError::Option { option: "aperture radius", must: "at most the baked one" });
    }
    let stop = if baked_radius > 0.0 { optics.aperture_radius / baked_radius } else { 1.0 };
    let sets = ray_sets(camera, options);
    let focus = SampleFocus::new(focus);
    let radius_px = |sample: &Sample| {
        let offset = focus.offset(sample.address());
        optics.splat_radius_px(optics.kappa(f64::from(sample.inverse_depth), offset))
    };
    let samples = salf.samples.to_vec();
    let thrown: Vec<_> =
        samples.par_iter().map(|sample| Thrown { sample, radius_px: radius_px(sample), stop }).collect();
    let mut sum = PictureSum::new([camera.width, camera.height]);
    let deposit = |index: usize, thrown: &Thrown, band: &mut Band| {
        // Fibonacci hashing: neighbours take different sets.
        let set = (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        thrown.deposit(&sets[set as usize % RAY_SETS], band);
    };
    sum.add(&thrown, Thrown::rows, deposit, progress)?;
    Ok(sum.into_picture())
}

/// Points of Owen-scrambled Sobol' sequences over footprint and aperture, a sequence a set.
fn ray_sets(camera: &Camera, options: &ScatterOptions) -> Vec<Vec<SampleRay>> {
    let aperture = ApertureSampler::new(&camera.aperture);
    let set = |set: usize| {
        let scramble = options.seed.wrapping_mul(0x9e37_79b1).wrapping_add(set as u32);
        let ray = |index: u32| {
            let [x, y, a, b] = sobol_burley::sample_4d(index, 0, scramble).map(f64::from);
            SampleRay { start: DVec2::new(2.0 * x - 1.0, 2.0 * y - 1.0), u: aperture.sample(a, b) }
        };
        (0..options.rays_a_sample).map(ray).collect()
    };
    (0..RAY_SETS).into_par_iter().map(set).collect()
}

/// A sample and the radius of its image.
struct Thrown<'a> {
    sample: &'a Sample,
    /// Signed radius of the aperture's image.
    radius_px: f64,
    /// The lens's aperture radius as a share of the baked one.
    stop: f64,
}

impl Thrown<'_> {
    /// The pixel rows that its rays may land in.
    fn rows(&self) -> Range<i64> {
        let center = f64::from(self.sample.center.y);
        let half = self.radius_px.abs() + f64::from(self.sample.half_size.y);
        (center - half).floor() as i64..((center + half).floor() as i64).saturating_add(1)
    }

    fn deposit(&self, rays: &[SampleRay], band: &mut Band) {
        let Self { sample, radius_px, stop } = *self;
        let (center, half_size) = (sample.center.as_dvec2(), sample.half_size.as_dvec2());
        let (weight, tilt) = (f64::from(sample.weight), sample.tilt.as_dvec2());
        let [r, g, b] = sample.radiance.as_dvec3().to_array();
        let rows = band.rows();
        for ray in rays {
            let y = (center.y + ray.start.y * half_size.y - ray.u.y * radius_px).floor() as i64;
            if !rows.contains(&y) {
                continue;
            }
            let u = ray.u * stop;
            if !is_visible_from(&sample.visibility, u) {
                continue;
            }
            let x = (center.x + ray.start.x * half_size.x + ray.u.x * radius_px).floor() as i64;
            let share = (weight + tilt.dot(u)).max(0.0) / rays.len() as f64;
            band.add(x, y, [r * share, g * share, b * share, share]);
        }
    }
}

/// Whether the aperture point u in [−1, 1]² is visible.
#[inline(always)]
fn is_visible_from(visibility: &Visibility, u: DVec2) -> bool {
    match visibility {
        Visibility::Open => true,
        Visibility::Cells { words, .. } => {
            let side = Visibility::side_of(words);
            let cell = |u: f64| (((u + 1.0) / 2.0 * side as f64) as usize).min(side - 1);
            Visibility::row(words, cell(u.y)) >> cell(u.x) & 1 == 1
        }
    }
}

#[cfg(test)]
mod tests;
