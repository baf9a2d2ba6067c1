//! Decodes a disparity map that is coded by colour, as Lytro Desktop exports it, with the help of some known disparities.
//!
//! The file does not specify which colours the program used, in which order, or how they follow the disparity; it is only known that there
//! is one curve through colour space along which disparity grows. So: known disparities in their order give an initial curve (medians
//! of their colours); the colours of the whole map refine it (`principal_curve`); along it the known disparities give a monotone
//! function (`monotone`). Every pixel is then assigned to the nearest place of the curve (`palette`). Colours away from it are
//! mixtures that compression made where the map jumps: they take the disparity of the nearest pixel that is no mixture.
//!
//! What does not fit is refused: a photograph has no such curve, or places on its curve do not determine disparities.

mod monotone;
mod palette;
mod principal_curve;

use crate::error::DisparityError;
use crate::view::Picture;
use monotone::MonotoneFunction;
use numerics::upper_median;
use palette::Palette;
use progress::Progress;
use rayon::prelude::*;

/// A disparity that is known from elsewhere, for instance from features that were matched between views.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Column of the map, pixels.
    pub x: usize,
    /// Row of the map, pixels.
    pub y: usize,
    /// The disparity there. Noise and some wrong ones (less than a third) do no harm.
    pub disparity: f32,
}

/// A decoded map.
#[derive(Clone, Debug, PartialEq)]
pub struct Decoded {
    /// Row by row from the top, in the units of the samples.
    pub disparity: Vec<f32>,
    /// The median distance between samples and the decoded map, as a share of the decoded range.
    pub residual: f32,
    /// The share of the samples that are within three times that (at least a hundredth of the range).
    pub agreeing: f32,
}

/// The number of samples that are needed.
pub const MIN_SAMPLES: usize = 40;

/// A median residual above this share of the range means that the map is no code. Colours unrelated to disparity leave 0.12 and more (the
/// median distance from the median of most distributions), noise of the samples a few hundredths.
pub const MAX_RESIDUAL: f32 = 0.06;

/// Half of the pixels have to be this near to the curve (of white, root of three squared channels). Compression
/// leaves 0.01.
const NEAR: f32 = 0.05;

/// A pixel this far from the curve is a mixture.
const MIXTURE: f32 = 0.1;

/// Decodes a map whose colours are a code, from `samples` of known disparity, whose unit the result has.
///
/// # Errors
/// [`DisparityError::TooFewSamples`], [`DisparityError::SampleOutside`], [`DisparityError::Size`] and [`DisparityError::NotFinite`]
/// (of "view 0") for input that cannot be used, [`DisparityError::NotColourCoded`] with the residual for a picture that is no such map,
/// and [`DisparityError::Cancelled`] if `progress` cancels.
pub fn decode(
    map: &Picture<'_>,
    samples: &[Sample],
    progress: &dyn Progress,
) -> Result<Decoded, DisparityError> {
    check(map, samples)?;
    let colours: Vec<([f32; 3], f32)> =
        samples.iter().map(|s| (steady_colour(map, s), s.disparity)).collect();
    let refused = |residual: f32, why: &str| {
        Err(DisparityError::NotColourCoded { percent: 100.0 * residual, why: why.to_string() })
    };
    let Some(start) = Palette::through(&initial_curve(&colours)) else {
        return refused(1.0, "its colours do not change with the disparity");
    };
    let palette = principal_curve::fit_principal_curve(start, map.rgb);
    progress.check()?;
    let places: Vec<(f32, f32)> = colours.iter().map(|(c, d)| (palette.nearest(*c).place, *d)).collect();
    let Some(growth) = MonotoneFunction::fit(&places) else {
        return refused(1.0, "its colours correspond to a single disparity");
    };
    let mut residuals: Vec<f32> = places.iter().map(|(place, d)| (growth.at(*place) - d).abs()).collect();
    let read: Vec<(f32, f32)> = map
        .rgb
        .par_iter()
        .map(|colour| {
            let nearest = palette.nearest(*colour);
            (growth.at(nearest.place), nearest.distance)
        })
        .collect();
    progress.report(0.8);
    progress.check()?;
    let range = growth.at(1.0) - growth.at(0.0);
    let residual = median_or_nan(&mut residuals) / range;
    if residual.is_nan() || residual > MAX_RESIDUAL {
        return refused(residual, "its colours do not follow the known disparities");
    }
    if median_or_nan(&mut read.iter().map(|r| r.1).collect::<Vec<_>>()) > NEAR {
        return refused(residual, "its colours do not lie on a curve");
    }
    let limit = (3.0 * residual).max(0.01) * range;
    let agreeing = residuals.iter().filter(|r| **r <= limit).count() as f32 / residuals.len() as f32;
    let disparity = without_mixtures(&read, map.width);
    progress.report(1.0);
    Ok(Decoded { disparity, residual, agreeing })
}

fn check(map: &Picture<'_>, samples: &[Sample]) -> Result<(), DisparityError> {
    let (width, height) = (map.width, map.height);
    if width == 0 || width.checked_mul(height) != Some(map.rgb.len()) {
        let what = format!("the map has {width} × {height} pixels, but {} colours", map.rgb.len());
        return Err(DisparityError::Size { view: 0, what });
    }
    if let Some(pixel) = map.rgb.iter().position(|rgb| !rgb.iter().all(|value| value.is_finite())) {
        return Err(DisparityError::NotFinite { view: 0, x: pixel % width, y: pixel / width });
    }
    if samples.len() < MIN_SAMPLES {
        return Err(DisparityError::TooFewSamples { samples: samples.len() });
    }
    let usable = |s: &Sample| s.x < width && s.y < height && s.disparity.is_finite();
    match samples.iter().position(|s| !usable(s)) {
        Some(sample) => Err(DisparityError::SampleOutside { sample }),
        None => Ok(()),
    }
}

/// The colour of a sample: the median of nine pixels, for each channel by itself.
fn steady_colour(map: &Picture<'_>, sample: &Sample) -> [f32; 3] {
    let rows = sample.y.saturating_sub(1)..(sample.y + 2).min(map.height);
    let columns = sample.x.saturating_sub(1)..(sample.x + 2).min(map.width);
    let around: Vec<[f32; 3]> =
        rows.flat_map(|y| columns.clone().map(move |x| map.rgb[y * map.width + x])).collect();
    middle_colour(&around)
}

/// Colours in the order of their disparities: medians of overlapping parts.
fn initial_curve(colours: &[([f32; 3], f32)]) -> Vec<[f32; 3]> {
    let mut sorted = colours.to_vec();
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    let sorted: Vec<[f32; 3]> = sorted.into_iter().map(|(colour, _)| colour).collect();
    // Parts of eleven samples or more outvote wrong ones.
    let parts = (sorted.len() / 8).clamp(4, 32);
    let half = (sorted.len() as f32 / parts as f32).max(5.5);
    (0..parts)
        .map(|k| {
            let middle = (k as f32 + 0.5) / parts as f32 * sorted.len() as f32;
            let (first, end) = ((middle - half).max(0.0) as usize, (middle + half) as usize);
            middle_colour(&sorted[first..end.min(sorted.len())])
        })
        .collect()
}

/// The median of each channel.
fn middle_colour(colours: &[[f32; 3]]) -> [f32; 3] {
    std::array::from_fn(|c| median_or_nan(&mut colours.iter().map(|colour| colour[c]).collect::<Vec<_>>()))
}

/// Disparities; mixtures are replaced by the nearest pixel that is none (by two passes over the picture, as in a
/// distance transform).
fn without_mixtures(read: &[(f32, f32)], width: usize) -> Vec<f32> {
    let mut disparity: Vec<f32> = read.iter().map(|r| r.0).collect();
    let mut away: Vec<u32> = read.iter().map(|r| if r.1 > MIXTURE { u32::MAX / 2 } else { 0 }).collect();
    let count = disparity.len();
    let mut take = |own: usize, other: usize| {
        if away[other] + 1 < away[own] {
            away[own] = away[other] + 1;
            disparity[own] = disparity[other];
        }
    };
    for i in 0..count {
        if i % width > 0 {
            take(i, i - 1);
        }
        if i >= width {
            take(i, i - width);
        }
    }
    for i in (0..count).rev() {
        if i % width + 1 < width {
            take(i, i + 1);
        }
        if i + width < count {
            take(i, i + width);
        }
    }
    disparity
}

/// NaN for no values.
fn median_or_nan(values: &mut [f32]) -> f32 {
    upper_median(values).unwrap_or(f32::NAN)
}
