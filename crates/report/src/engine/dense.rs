//! Dense scatter: every sample adds to every pixel of its aperture image. The baseline for the splat.

use crate::measurement::stopwatch::median_seconds;
use rayon::prelude::*;
use salf::Salf;
use std::time::Instant;

/// Rows per thread.
const BAND_ROWS: i64 = 64;

/// Approximate number of timed pixel additions; the time of all additions is extrapolated.
const TIMED_ADDITIONS: f64 = 3e9;

/// Time of dense scatter of a field whose samples see the whole disc, s. If that would take too long, only
/// every n-th sample is scattered and the time is multiplied by n.
pub fn dense_seconds(salf: &Salf) -> f64 {
    let camera = &salf.camera;
    let optics = camera.optics();
    let discs: Vec<_> = salf
        .samples
        .iter()
        .map(|sample| {
            let radius = optics.splat_radius_px(optics.standard_kappa(sample.inverse_depth.into()));
            // A disc narrower than a pixel contributes to four.
            let radius = (radius.abs() as f32).max(0.6);
            let [r, g, b] = (sample.radiance / (std::f32::consts::PI * radius * radius)).to_array();
            (sample.center, radius, [r, g, b, 1.0 / (std::f32::consts::PI * radius * radius)])
        })
        .collect();
    let additions: f64 = discs.iter().map(|(_, radius, _)| f64::from(4.0 * radius * radius)).sum();
    let stride = (additions / TIMED_ADDITIONS).ceil().max(1.0) as usize;
    let (width, height) = (i64::from(camera.width), i64::from(camera.height));
    let mut sums = vec![[0.0f32; 4]; (width * height) as usize];
    let mut time_once = || {
        let start = Instant::now();
        sums.par_chunks_mut((BAND_ROWS * width) as usize).enumerate().for_each(|(band, sums)| {
            let first = band as i64 * BAND_ROWS;
            let end = first + sums.len() as i64 / width;
            sums.fill([0.0; 4]);
            for (center, radius, light) in discs.iter().step_by(stride) {
                let rows = ((center.y - radius) as i64).max(first)..((center.y + radius) as i64 + 1).min(end);
                for y in rows {
                    let dy = y as f32 + 0.5 - center.y;
                    let half = (radius * radius - dy * dy).max(0.0).sqrt();
                    let columns =
                        ((center.x - half) as i64).max(0)..((center.x + half) as i64 + 1).min(width);
                    let row = ((y - first) * width) as usize;
                    for x in columns {
                        let pixel = &mut sums[row + x as usize];
                        (0..4).for_each(|c| pixel[c] += light[c]);
                    }
                }
            }
        });
        std::hint::black_box(&sums);
        start.elapsed().as_secs_f64() * stride as f64
    };
    median_seconds(&mut [time_once(), time_once(), time_once()])
}
