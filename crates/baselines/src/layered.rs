//! Blur by depth in layers: the pinhole picture is cut by depth, each layer blurred whole, and the layers composited.
//!
//! A layer's colour and its mask are blurred alike by the aperture's image, then laid over what is behind:
//!
//! ```text
//! picture ← layer + (1 − mask)·picture,     from the back
//! ```
//!
//! The masks keep sharp surfaces from bleeding into blurred ones, and a near layer turns transparent at its rim. What it
//! hides is missing, though: behind a layer is a hole, and the picture's coverage falls below 1 there (normalise
//! exposure fills it with the colours around it). Where a surface passes from one layer to the next, two half-transparent
//! rims meet and leave a quarter open: a seam. Light ends at the frame.

use crate::aperture_blur::ApertureBlur;
use crate::error::{check_hits, check_option};
use crate::{BaselineError, FirstHits};
use lens::{Camera, Picture};
use progress::{Progress, Stage};
use std::collections::BTreeMap;

/// How the picture is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayeredOptions {
    /// Slices of depth, evenly spaced in 1/z, 1 to 256. Each is cut again to as many slices of painted defocus, if there is
    /// any; slices without a pixel cost nothing.
    pub layers: u32,
}

impl Default for LayeredOptions {
    fn default() -> Self {
        Self { layers: 32 }
    }
}

/// Pixels of about the same depth and defocus.
struct Layer {
    pixels: Vec<u32>,
    inverse_depth: f64,
    kappa: f64,
}

/// Blurs the pinhole picture `hits` layer by layer. See the module for what its coverage means.
///
/// # Errors
/// [`BaselineError`] if `hits` belong to another camera, an option is out of range, or `progress` is cancelled.
pub fn layered_blur(
    hits: &FirstHits,
    camera: &Camera,
    options: &LayeredOptions,
    progress: &dyn Progress,
) -> Result<Picture, BaselineError> {
    check_hits(hits, camera)?;
    check_option("layers", options.layers, 1..=256, "1 to 256")?;
    let optics = camera.optics();
    let (width, height) = (camera.width as usize, camera.height as usize);
    let mut picture = vec![[0.0f32; 4]; width * height];
    let layers = back_to_front(hits, camera, options.layers);
    for (index, layer) in layers.iter().enumerate() {
        let stage = Stage::new(
            progress,
            index as f32 / layers.len() as f32,
            (index + 1) as f32 / layers.len() as f32,
        );
        let mut colour = vec![[0.0; 4]; width * height];
        for &pixel in &layer.pixels {
            let [r, g, b] = hits.radiance[pixel as usize];
            colour[pixel as usize] = [r, g, b, 1.0];
        }
        if let Some(blur) = ApertureBlur::new(&camera.aperture, optics.splat_radius_px(layer.kappa), height)?
        {
            colour = blur.apply(&colour, width, &stage)?;
        }
        for (behind, over) in picture.iter_mut().zip(&colour) {
            let through = 1.0 - over[3].min(1.0);
            (0..4).for_each(|c| behind[c] = over[c] + through * behind[c]);
        }
        stage.check()?;
        stage.report(1.0);
    }
    Ok(Picture {
        width: camera.width,
        height: camera.height,
        radiance: picture.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
        coverage: picture.iter().map(|pixel| pixel[3]).collect(),
        colour_coverage: None,
    })
}

/// Cuts the picture by depth, and by what paint adds to the defocus.
fn back_to_front(hits: &FirstHits, camera: &Camera, slices: u32) -> Vec<Layer> {
    let optics = camera.optics();
    let inverse_depths: Vec<f64> = hits.depth.iter().map(|&depth| 1.0 / f64::from(depth)).collect();
    let painted: Vec<f64> = (0..hits.kappa.len())
        .map(|k| match hits.focus[k].is_standard() {
            true => 0.0,
            false => hits.kappa[k] - optics.standard_kappa(inverse_depths[k]),
        })
        .collect();
    let by_depth = Slices::new(&inverse_depths, slices);
    let by_paint = Slices::new(&painted, slices);
    let mut cut: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
    for k in 0..painted.len() {
        let slice = [by_depth.slice_of(inverse_depths[k]), by_paint.slice_of(painted[k])];
        cut.entry(slice).or_default().push(k as u32);
    }
    let mut layers: Vec<Layer> = cut
        .into_values()
        .map(|pixels| {
            let mean = |values: &[f64]| {
                pixels.iter().map(|&k| values[k as usize]).sum::<f64>() / pixels.len() as f64
            };
            Layer { inverse_depth: mean(&inverse_depths), kappa: mean(&hits.kappa), pixels }
        })
        .collect();
    layers.sort_by(|a, b| a.inverse_depth.total_cmp(&b.inverse_depth));
    layers
}

/// A range in equal slices.
struct Slices {
    low: f64,
    high: f64,
    count: u32,
}

impl Slices {
    fn new(values: &[f64], count: u32) -> Self {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self { low, high, count }
    }

    fn slice_of(&self, value: f64) -> u32 {
        if self.high <= self.low {
            return 0;
        }
        let share = (value - self.low) / (self.high - self.low);
        ((share * f64::from(self.count)) as u32).min(self.count - 1)
    }
}

#[cfg(test)]
mod tests;
