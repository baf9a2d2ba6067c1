//! How far outside of the frame rays may start that land inside.

use super::sample_ray::SampleRays;
use glam::DVec2;
use lens::ApertureSampler;
use progress::{Cancelled, Progress};
use rayon::prelude::*;

/// Probing rays a step.
const PROBES: u32 = 1 << 18;
/// The first band that is probed, half-heights.
const FIRST_BAND: f64 = 0.5;
/// The widest band, half-heights.
const WIDEST_BAND: f64 = 16.0;
/// The band is this many times the farthest displacement that was seen.
const SLACK: f64 = 1.05;
/// 1/g, 1/g², 1/g³, 1/g⁴ of the four-dimensional golden ratio g⁵ = g + 1: steps of a low-discrepancy sequence
/// (Roberts 2018).
const STEPS: [f64; 4] =
    [0.856_674_883_854_502_8, 0.733_891_856_627_126, 0.628_706_721_037_807_8, 0.538_597_257_223_61];

/// The width of the guard band, px: found by sending rays from a band around the frame and doubling it until
/// no ray that lands inside has come from near its rim. 0 if none is displaced.
pub(super) fn width_px(rays: &SampleRays, progress: &dyn Progress) -> Result<i64, Cancelled> {
    let half_height = rays.camera.height as f64 / 2.0;
    let mut band = FIRST_BAND;
    loop {
        progress.check()?;
        let farthest = farthest_displacement(rays, band * half_height) / half_height;
        if farthest == 0.0 {
            return Ok(0);
        }
        if farthest * SLACK < band || band >= WIDEST_BAND {
            return Ok(((farthest * SLACK).min(WIDEST_BAND) * half_height).ceil() as i64);
        }
        band *= 2.0;
    }
}

/// The largest displacement, along either axis, among rays that start at most `band_px` outside of the frame
/// and land inside.
fn farthest_displacement(rays: &SampleRays, band_px: f64) -> f64 {
    let size = DVec2::new(rays.camera.width as f64, rays.camera.height as f64);
    let aperture = ApertureSampler::new(&rays.camera.aperture);
    let displacement = |probe: u32| {
        let [x, y, a, b] = STEPS.map(|step| (0.5 + step * f64::from(probe)).fract());
        let from = DVec2::new(x, y) * (size + 2.0 * band_px) - band_px;
        let u = aperture.sample(a, b) * rays.camera.aperture_radius;
        let displacement = rays.trace(from, u).displacement_px;
        let to = from + displacement;
        let lands = to.cmpge(DVec2::ZERO).all() && to.cmplt(size).all();
        if lands { displacement.abs().max_element() } else { 0.0 }
    };
    (0..PROBES).into_par_iter().map(displacement).reduce(|| 0.0, f64::max)
}
