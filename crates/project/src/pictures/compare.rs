//! Error measures between two pictures.

use crate::pictures::output::srgb_bytes;
use crate::{LinearPicture, ProjectError};
use numerics::psnr;
use nv_flip::{FlipImageRgb8, FlipPool};
use serde::Serialize;

/// Added to the square of the reference in relMSE, so that black does not divide by 0.
const RELATIVE_FLOOR: f64 = 1e-2;

/// The differences between a picture and a reference. "Clipped": of linear values clipped to [0, 1].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Root of the mean square error, clipped.
    pub rmse: f64,
    /// Peak signal-to-noise ratio in dB for a peak of 1, clipped: −20 log₁₀ RMSE; 200 for equal pictures.
    pub psnr: f64,
    /// Root of the mean square error, not clipped.
    pub rmse_unclipped: f64,
    /// Mean of (a − b)²/(b² + 0.01), not clipped.
    pub rel_mse: f64,
    /// Mean of a − b over the mean of b, not clipped; 0 if b is black and equal.
    pub signed_mean_error: f64,
    /// The same, clipped.
    pub signed_mean_error_clipped: f64,
    /// The largest |a − b|, not clipped.
    pub largest_difference: f64,
    /// Mean of FLIP (Andersson et al. 2020) on sRGB-encoded clipped 8-bit pictures at 67 pixels per degree, in [0,
    /// 1]; NaN if there are undefined pixels, which FLIP itself would treat as black or white.
    pub flip: f64,
    /// Number of pixels for which either picture has a value that is not finite. If there are any, the other figures
    /// are not finite.
    pub undefined_pixels: usize,
}

/// The differences between two pictures, one value per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMaps {
    /// |a − b|, linear RGB.
    pub difference: Vec<[f32; 3]>,
    /// FLIP in [0, 1].
    pub flip: Vec<f32>,
}

/// Compares `a` with the reference `b`. Values that are not finite make every figure that they enter not finite.
///
/// # Errors
/// [`ProjectError::SizesDiffer`] if the sizes differ.
pub fn compare(a: &LinearPicture, b: &LinearPicture) -> Result<Comparison, ProjectError> {
    check_same_size(a, b)?;
    let count = (a.rgb.len() * 3).max(1) as f64;
    let mut sums = ErrorSums::default();
    for (&a, &b) in a.rgb.iter().flatten().zip(b.rgb.iter().flatten()) {
        sums.add(a as f64, b as f64);
    }
    let mean_square = sums.square_clipped / count;
    let is_undefined = |(a, b): &(&[f32; 3], &[f32; 3])| a.iter().chain(b.iter()).any(|c| !c.is_finite());
    let undefined_pixels = a.rgb.iter().zip(&b.rgb).filter(is_undefined).count();
    let flip = || f64::from(FlipPool::from_image(&flip_image(a, b)).mean());
    let relative = |difference: f64, mean: f64| if difference == 0.0 { 0.0 } else { difference / mean };
    Ok(Comparison {
        width: a.width,
        height: a.height,
        rmse: mean_square.sqrt(),
        psnr: psnr(mean_square),
        rmse_unclipped: (sums.square / count).sqrt(),
        rel_mse: sums.relative_square / count,
        signed_mean_error: relative(sums.difference, sums.reference),
        signed_mean_error_clipped: relative(sums.difference_clipped, sums.reference_clipped),
        largest_difference: sums.largest,
        flip: if undefined_pixels == 0 { flip() } else { f64::NAN },
        undefined_pixels,
    })
}

/// The differences of `a` from the reference `b`, pixel by pixel.
///
/// # Errors
/// [`ProjectError::SizesDiffer`] if the sizes differ.
pub fn error_maps(a: &LinearPicture, b: &LinearPicture) -> Result<ErrorMaps, ProjectError> {
    check_same_size(a, b)?;
    let difference = |(a, b): (&[f32; 3], &[f32; 3])| [0, 1, 2].map(|k| (a[k] - b[k]).abs());
    let difference = a.rgb.iter().zip(&b.rgb).map(difference).collect();
    Ok(ErrorMaps { difference, flip: flip_image(a, b).to_vec() })
}

fn check_same_size(a: &LinearPicture, b: &LinearPicture) -> Result<(), ProjectError> {
    let (a, b) = ([a.width, a.height], [b.width, b.height]);
    if a == b { Ok(()) } else { Err(ProjectError::SizesDiffer { a, b }) }
}

fn flip_image(a: &LinearPicture, b: &LinearPicture) -> nv_flip::FlipImageFloat {
    let [test, reference] = [a, b]
        .map(|picture| FlipImageRgb8::with_data(picture.width, picture.height, &srgb_bytes(&picture.rgb)));
    nv_flip::flip(reference, test, nv_flip::DEFAULT_PIXELS_PER_DEGREE)
}

#[derive(Default)]
struct ErrorSums {
    square_clipped: f64,
    square: f64,
    relative_square: f64,
    difference: f64,
    reference: f64,
    difference_clipped: f64,
    reference_clipped: f64,
    largest: f64,
}

impl ErrorSums {
    fn add(&mut self, a: f64, b: f64) {
        let difference = a - b;
        let clipped = a.clamp(0.0, 1.0) - b.clamp(0.0, 1.0);
        self.square_clipped += clipped * clipped;
        self.square += difference * difference;
        self.relative_square += difference * difference / (b * b + RELATIVE_FLOOR);
        self.difference += difference;
        self.reference += b;
        self.difference_clipped += clipped;
        self.reference_clipped += b.clamp(0.0, 1.0);
        // Not f64::max, which would hide a NaN.
        if difference.abs() > self.largest || difference.is_nan() {
            self.largest = difference.abs();
        }
    }
}
