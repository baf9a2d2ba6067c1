//! How far a picture is from the converged one, as a whole and beside outlines.

use lens::{Camera, Picture};
use rayon::prelude::*;
use std::sync::Arc;
use trace::{Ray, Tracer};

/// How far from an outline its band reaches, px.
const REACH_PX: usize = 6;

/// Neighbouring pixels that differ by more parallax over half the aperture than this have an outline between them, px.
const JUMP_PX: f64 = 1.6;

/// The pixels beside outlines.
#[derive(Clone, Debug, Default)]
pub struct Band(Option<Arc<Vec<bool>>>);

impl Band {
    /// Around the depth discontinuities of a scene's pinhole picture.
    pub fn of_scene(tracer: &Tracer, camera: &Camera) -> Self {
        let (width, height) = (camera.width as usize, camera.height as usize);
        let depths = inverse_depths(tracer, camera);
        let per_depth = camera.optics().splat_radius_px(1.0);
        let jumps = |a: usize, b: usize| f64::from((depths[a] - depths[b]).abs()) * per_depth > JUMP_PX;
        let is_edge = |x: usize, y: usize| {
            let at = y * width + x;
            x + 1 < width && jumps(at, at + 1) || y + 1 < height && jumps(at, at + width)
        };
        Self::around(width, height, is_edge)
    }

    /// Around the pixels where `is_edge` holds.
    pub fn around(width: usize, height: usize, is_edge: impl Fn(usize, usize) -> bool) -> Self {
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
}

/// 1/z of the nearest surface at the middle of each pixel; 0 where there is none.
pub fn inverse_depths(tracer: &Tracer, camera: &Camera) -> Vec<f32> {
    let width = camera.width;
    let of = |index: u32| {
        let pixel = glam::DVec2::new(f64::from(index % width) + 0.5, f64::from(index / width) + 0.5);
        let hit = tracer.first_hit(&Ray::of_pinhole(camera, glam::DVec2::ZERO, pixel));
        hit.map_or(0.0, |hit| (1.0 / hit.t) as f32)
    };
    (0..width * camera.height).into_par_iter().map(of).collect()
}

/// A picture against the converged one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// dB, on values clipped to [0, 1].
    pub psnr: f64,
    /// The same within the band, if there is one.
    pub band_psnr: Option<f64>,
    /// Root mean square difference of coverage within the band.
    pub band_coverage_rms: Option<f64>,
}

/// Compares two pictures of one size.
pub fn compare(picture: &Picture, converged: &Picture, band: &Band) -> Difference {
    let square = |index: usize| -> f64 {
        let (a, b) = (picture.radiance[index], converged.radiance[index]);
        (0..3).map(|c| f64::from(a[c].clamp(0.0, 1.0) - b[c].clamp(0.0, 1.0)).powi(2)).sum()
    };
    let psnr = |sum: f64, pixels: usize| {
        let mean = sum / (3 * pixels) as f64;
        if mean > 0.0 { -10.0 * mean.log10() } else { 200.0 }
    };
    let pixels = picture.radiance.len();
    let whole = psnr((0..pixels).map(square).sum(), pixels);
    let Some(band) = &band.0 else {
        return Difference { psnr: whole, band_psnr: None, band_coverage_rms: None };
    };
    let within: Vec<usize> = (0..pixels).filter(|&index| band[index]).collect();
    let coverage = |&index: &usize| f64::from(picture.coverage[index] - converged.coverage[index]).powi(2);
    let covered: f64 = within.iter().map(coverage).sum::<f64>() / within.len() as f64;
    Difference {
        psnr: whole,
        band_psnr: Some(psnr(within.iter().map(|&index| square(index)).sum(), within.len())),
        band_coverage_rms: Some(covered.sqrt()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_band_is_six_pixels_wide_to_each_side() {
        let band = Band::around(40, 20, |x, y| (x, y) == (20, 10));
        let band = band.0.unwrap();
        assert_eq!(band.iter().filter(|&&within| within).count(), 13 * 13);
        assert!(band[4 * 40 + 14] && band[16 * 40 + 26] && !band[4 * 40 + 13] && !band[3 * 40 + 20]);
        assert!(Band::around(4, 4, |_, _| false).0.is_none());
    }

    #[test]
    fn differences_are_those_of_the_pixels() {
        let black = Picture::black(40, 20);
        let mut grey = black.clone();
        grey.radiance.iter_mut().for_each(|pixel| *pixel = [0.1; 3]);
        grey.coverage[10 * 40 + 20] = 0.5;
        let band = Band::around(40, 20, |x, y| (x, y) == (20, 10));
        let found = compare(&grey, &black, &band);
        assert!((found.psnr - 20.0).abs() < 1e-4 && (found.band_psnr.unwrap() - 20.0).abs() < 1e-4);
        assert!((found.band_coverage_rms.unwrap() - 0.5 / 13.0).abs() < 1e-6);
        assert_eq!(compare(&black, &black, &Band::default()).psnr, 200.0);
    }
}
