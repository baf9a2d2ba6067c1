//! The band of pixels near outlines (depth discontinuities).

use lens::Camera;
use rayon::prelude::*;
use std::sync::Arc;
use trace::{Ray, Tracer};

/// Half width of the band, px.
const REACH_PX: usize = 6;

/// Neighbouring pixels are separated by an outline if their parallax over half the aperture differs by more
/// than this, px.
const JUMP_PX: f64 = 1.6;

/// The band of pixels near outlines (depth discontinuities).
#[derive(Clone, Debug, Default)]
pub struct OutlineBand(Option<Arc<Vec<bool>>>);

impl OutlineBand {
    /// Around the depth discontinuities of a scene's pinhole picture.
    pub fn from_scene(tracer: &Tracer, camera: &Camera) -> Self {
        Self::from_depths(&inverse_depths(tracer, camera), camera)
    }

    /// Around the discontinuities of a picture's [`inverse_depths`].
    pub fn from_depths(depths: &[f32], camera: &Camera) -> Self {
        let (width, height) = (camera.width as usize, camera.height as usize);
        let per_depth = camera.optics().splat_radius_px(1.0);
        let jumps = |a: usize, b: usize| f64::from((depths[a] - depths[b]).abs()) * per_depth > JUMP_PX;
        let is_edge = |x: usize, y: usize| {
            let at = y * width + x;
            x + 1 < width && jumps(at, at + 1) || y + 1 < height && jumps(at, at + width)
        };
        Self::from_edges(width, height, is_edge)
    }

    /// The band around the pixels where `is_edge` holds for column and row.
    pub fn from_edges(width: usize, height: usize, is_edge: impl Fn(usize, usize) -> bool) -> Self {
        let mut rows = vec![false; width * height];
        for y in 0..height {
            for x in (0..width).filter(|&x| is_edge(x, y)) {
                rows[y * width..][x.saturating_sub(REACH_PX)..(x + REACH_PX + 1).min(width)].fill(true);
            }
        }
        let mut band = vec![false; width * height];
        for y in 0..height {
            for near in y.saturating_sub(REACH_PX)..(y + REACH_PX + 1).min(height) {
                for x in 0..width {
                    band[y * width + x] |= rows[near * width + x];
                }
            }
        }
        Self(band.contains(&true).then(|| Arc::new(band)))
    }

    /// PSNR within the band, dB, on linear values clipped to [0, 1]; 200 for equal pictures, `None` without a
    /// band.
    pub fn psnr(&self, a: &[[f32; 3]], b: &[[f32; 3]]) -> Option<f64> {
        let within = a.iter().zip(b).zip(self.0.as_ref()?.iter()).filter(|(_, within)| **within);
        let squares = within.map(|(pair, _)| squared_difference(pair));
        let (sum, pixels) = squares.fold((0.0, 0), |(sum, pixels), square| (sum + square, pixels + 1));
        Some(psnr_from_sum(sum, pixels))
    }

    /// The root mean square of differences within the band; `None` without one.
    pub fn rms(&self, a: &[f32], b: &[f32]) -> Option<f64> {
        let within = a.iter().zip(b).zip(self.0.as_ref()?.iter()).filter(|(_, within)| **within);
        let (sum, pixels) =
            within.fold((0.0, 0), |(sum, pixels), ((a, b), _)| (sum + f64::from(a - b).powi(2), pixels + 1));
        Some((sum / f64::from(pixels)).sqrt())
    }
}

/// PSNR of two pictures of one size, dB, on linear values clipped to [0, 1]; 200 for equal ones.
pub fn picture_psnr(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    psnr_from_sum(a.iter().zip(b).map(squared_difference).sum(), a.len())
}

/// The squared difference of two pixels, clipped.
fn squared_difference((a, b): (&[f32; 3], &[f32; 3])) -> f64 {
    (0..3).map(|c| f64::from(a[c].clamp(0.0, 1.0) - b[c].clamp(0.0, 1.0)).powi(2)).sum()
}

/// PSNR from the sum of squared differences, dB.
fn psnr_from_sum(sum: f64, pixels: usize) -> f64 {
    numerics::psnr(sum / (3 * pixels) as f64)
}

/// 1/z of the nearest surface at the middle of each pixel; 0 where there is none.
pub fn inverse_depths(tracer: &Tracer, camera: &Camera) -> Vec<f32> {
    let width = camera.width;
    let inverse_depth = |index: u32| {
        let pixel = glam::DVec2::new(f64::from(index % width) + 0.5, f64::from(index / width) + 0.5);
        let hit = tracer.first_hit(&Ray::pinhole(camera, glam::DVec2::ZERO, pixel));
        hit.map_or(0.0, |hit| (1.0 / hit.t) as f32)
    };
    (0..width * camera.height).into_par_iter().map(inverse_depth).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_band_is_six_pixels_wide_to_each_side() {
        let band = OutlineBand::from_edges(40, 20, |x, y| (x, y) == (20, 10));
        let band = band.0.unwrap();
        assert_eq!(band.iter().filter(|&&within| within).count(), 13 * 13);
        assert!(band[4 * 40 + 14] && band[16 * 40 + 26] && !band[4 * 40 + 13] && !band[3 * 40 + 20]);
        assert!(OutlineBand::from_edges(4, 4, |_, _| false).0.is_none());
    }

    #[test]
    fn differences_are_those_of_the_pixels() {
        let (black, grey) = (vec![[0.0f32; 3]; 800], vec![[0.1f32; 3]; 800]);
        let band = OutlineBand::from_edges(40, 20, |x, y| (x, y) == (20, 10));
        assert!((picture_psnr(&grey, &black) - 20.0).abs() < 1e-4);
        assert!((band.psnr(&grey, &black).unwrap() - 20.0).abs() < 1e-4);
        let mut beside = black.clone();
        beside[0] = [1.0; 3];
        assert_eq!((band.psnr(&beside, &black), picture_psnr(&black, &black)), (Some(200.0), 200.0));
        let (mut half, whole) = (vec![1.0f32; 800], vec![1.0f32; 800]);
        half[10 * 40 + 20] = 0.5;
        assert!((band.rms(&half, &whole).unwrap() - 0.5 / 13.0).abs() < 1e-6);
        assert_eq!(OutlineBand::default().psnr(&black, &grey), None);
    }
}
