//! Blur by depth, gathered: the plainest blur of the pinhole picture.
//!
//! Every pixel takes the mean of the pinhole picture over its *own* circle of confusion (a gather, as image
//! editors do it). It has one surface per pixel, so it cannot see behind an occluder, cannot make a near
//! occluder transparent, bleeds sharp edges into blurred surfaces and ends light at the frame.

use crate::error::check_hits;
use crate::{BaselineError, FirstHits};
use lens::{Camera, Picture};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// Most points a side of the grid over the aperture's square that a pixel gathers from: bounds the time.
const MAX_TAPS_PER_SIDE: f64 = 64.0;

/// Blurs the pinhole picture `hits` by each pixel's circle of confusion, painted or not. Coverage is 1.
///
/// # Errors
/// [`BaselineError`] if `hits` belong to another camera, an option is out of range, or `progress` is cancelled.
pub fn gather_blur(
    hits: &FirstHits,
    camera: &Camera,
    progress: &dyn Progress,
) -> Result<Picture, BaselineError> {
    check_hits(hits, camera)?;
    let (width, height) = (camera.width as usize, camera.height as usize);
    let optics = camera.optics();
    let widest = hits.kappa.iter().map(|&kappa| optics.splat_radius_px(kappa).abs()).fold(0.0, f64::max);
    // One point a pixel of the widest circle.
    let taps = aperture_taps(camera, (2.0 * widest).ceil().clamp(4.0, MAX_TAPS_PER_SIDE) as usize);
    let total: f32 = taps.iter().map(|tap| tap.2).sum();
    let done = AtomicU32::new(0);
    let rows: Result<Vec<Vec<[f32; 3]>>, Cancelled> = (0..height)
        .into_par_iter()
        .map(|y| {
            progress.check()?;
            let row = (0..width).map(|x| {
                let radius = optics.splat_radius_px(hits.kappa[y * width + x]) as f32;
                // Below half a pixel the disc is the pixel itself.
                if radius.abs() <= 0.5 {
                    return hits.radiance[y * width + x];
                }
                let mut sum = [0.0f32; 3];
                for &(u, v, transmission) in &taps {
                    let column = x as f32 - u * radius;
                    let row = y as f32 + v * radius;
                    let column = (column.round().max(0.0) as usize).min(width - 1);
                    let row = (row.round().max(0.0) as usize).min(height - 1);
                    let rgb = hits.radiance[row * width + column];
                    (0..3).for_each(|c| sum[c] += rgb[c] * transmission);
                }
                sum.map(|c| c / total)
            });
            let row = row.collect();
            progress.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / height as f32);
            Ok(row)
        })
        .collect();
    Ok(Picture {
        width: camera.width,
        height: camera.height,
        radiance: rows?.concat(),
        coverage: vec![1.0; width * height],
        colour_coverage: None,
    })
}

/// Points of the unit aperture on a grid of `side` × `side`, with what passes there.
fn aperture_taps(camera: &Camera, side: usize) -> Vec<(f32, f32, f32)> {
    let at = |k: usize| -1.0 + 2.0 * (k as f64 + 0.5) / side as f64;
    let grid = (0..side).flat_map(|j| (0..side).map(move |i| glam::DVec2::new(at(i), at(j))));
    let open: Vec<_> = grid
        .map(|u| (u.x as f32, u.y as f32, camera.aperture.transmission(u) as f32))
        .filter(|tap| tap.2 > 0.0)
        .collect();
    // A mask may be open only between the grid's points: then it is as small as a pinhole here.
    if open.is_empty() { vec![(0.0, 0.0, 1.0)] } else { open }
}

#[cfg(test)]
mod tests {
    use super::*;
    use progress::Unwatched;

    #[test]
    fn a_point_becomes_its_disc_and_a_sharp_picture_stays() {
        let camera = Camera { width: 41, height: 41, ..Camera::default() };
        let kappa = camera.optics().kappa_for_circle_px(10.0).unwrap();
        let mut hits = FirstHits::background(41, 41);
        hits.radiance[20 * 41 + 20] = [1.0; 3];
        let sharp = gather_blur(&hits, &camera, &Unwatched).unwrap();
        assert_eq!(sharp.radiance, hits.radiance);

        hits.kappa.fill(kappa);
        let blurred = gather_blur(&hits, &camera, &Unwatched).unwrap();
        let lit = blurred.radiance.iter().filter(|rgb| rgb[0] > 0.0).count() as f64;
        let disc = std::f64::consts::PI * 25.0;
        assert!((lit / disc - 1.0).abs() < 0.15, "{lit} pixels are lit, a disc has {disc}");
        let sum: f32 = blurred.radiance.iter().map(|rgb| rgb[0]).sum();
        assert!((sum - 1.0).abs() < 0.05, "a uniform blur keeps the sum: {sum}");
    }

    #[test]
    fn a_defocused_wall_stays_uniform() {
        let camera = Camera { width: 20, height: 20, ..Camera::default() };
        let mut hits = FirstHits::background(20, 20);
        hits.radiance.fill([0.5, 0.25, 2.0]);
        hits.kappa.fill(camera.optics().kappa_for_circle_px(-9.0).unwrap());
        let found = gather_blur(&hits, &camera, &Unwatched).unwrap();
        for rgb in found.radiance {
            (0..3).for_each(|c| assert!((rgb[c] - [0.5, 0.25, 2.0][c]).abs() < 1e-5, "{rgb:?}"));
        }
    }

    #[test]
    fn what_cannot_be_is_refused_and_what_is_unwanted_stops() {
        let camera = Camera { width: 8, height: 8, ..Camera::default() };
        let hits = FirstHits::background(8, 9);
        let found = gather_blur(&hits, &camera, &Unwatched);
        assert_eq!(found, Err(BaselineError::OtherCamera { actual: [8, 9], camera: [8, 8] }));
        let incomplete = FirstHits { kappa: vec![0.0; 3], ..FirstHits::background(8, 8) };
        assert!(matches!(gather_blur(&incomplete, &camera, &Unwatched), Err(BaselineError::Option { .. })));
        let hits = FirstHits::background(8, 8);
        assert_eq!(gather_blur(&hits, &camera, &crate::test_light::Unwanted), Err(BaselineError::Cancelled));
    }
}
