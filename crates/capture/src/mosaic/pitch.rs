//! The width of a mosaic's micro-images, detected from its pixels.
//!
//! Within a micro-image neighbouring pixels show nearly the same spot, from one micro-image to the next they do not; where lenses darken
//! toward their borders, brightness rises and falls once per micro-image. Either way the mean difference of neighbouring columns
//!
//! ```text
//! D(x) = mean over y of |I(x + 1, y) − I(x, y)|
//! ```
//!
//! repeats with the pitch. For each pitch p the test is how much of D's variance (with slow variation removed) the mean over each x mod p
//! explains; the pitch is the least p that explains nearly as much as the best, if it explains much and the period is strong: JPEG's
//! blocks of 8 are not micro-images. The same for rows.

use super::png_rows::PngRows;
use image::{DynamicImage, Limits};
use scene::LoadOptions;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Candidate pitches, px: Lytro has 10, 14 and 15; renderers choose freely.
const PITCHES: std::ops::RangeInclusive<usize> = 3..=40;
/// The most rows, from the middle, that are analysed.
const ROWS: usize = 480;

/// Detects the pitch of a mosaic, across and down; `None` if the picture is none.
pub(crate) fn detect_pitch(file: &Path, options: &LoadOptions) -> Option<[u32; 2]> {
    let (levels, width) = band(file, options)?;
    let rows = levels.len() / width;
    let difference = |a: usize, b: usize| f64::from((levels[a] - levels[b]).abs());
    let across =
        (0..width - 1).map(|x| (0..rows).map(|y| difference(y * width + x, y * width + x + 1)).sum());
    let down =
        (0..rows - 1).map(|y| (0..width).map(|x| difference(y * width + x, (y + 1) * width + x)).sum());
    let across = period(&across.collect::<Vec<f64>>())?;
    // The band of rows begins anywhere; only the period counts.
    let down = period(&down.collect::<Vec<f64>>())?;
    // Blocks of a strongly compressed JPEG are as strong.
    let is_blocks = |period: usize| period.is_multiple_of(8);
    let is_jpeg = crate::files::whole_file::head(file, 2) == [0xFF, 0xD8];
    (!(is_jpeg && is_blocks(across) && is_blocks(down))).then_some([across as u32, down as u32])
}

/// Brightness of rows from the middle of a picture, and its width.
fn band(file: &Path, options: &LoadOptions) -> Option<(Vec<f32>, usize)> {
    let middle_rows = |height: u32| {
        let rows = (height as usize).min(ROWS);
        (height as usize - rows) / 2..(height as usize - rows) / 2 + rows
    };
    let is_usable = |size: [u32; 2]| {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        size.iter().all(|side| *side >= 24)
            && pixels <= options.max_texels
            && u64::from(size[0]) * ROWS as u64 * 4 <= options.max_memory / 4
    };
    if let Some(rows) = PngRows::open(file, options.max_memory) {
        let mut rows = rows.ok()?;
        if !is_usable(rows.size) {
            return None;
        }
        let (band_rows, pixel_bytes, is_deep) = (middle_rows(rows.size[1]), rows.pixel_bytes(), rows.is_deep);
        // Green, or grey.
        let offset = if rows.channels >= 3 { pixel_bytes / rows.channels } else { 0 };
        let mut levels = Vec::new();
        for y in 0..band_rows.end {
            let row = rows.next().ok()?;
            if y >= band_rows.start {
                let level = |pixel: &[u8]| {
                    let high = f32::from(pixel[offset]);
                    if is_deep { high + f32::from(pixel[offset + 1]) / 256.0 } else { high }
                };
                levels.extend(row.chunks_exact(pixel_bytes).map(level));
            }
        }
        return Some((levels, rows.size[0] as usize));
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(options.max_memory / 2);
    let decoder = scene::open_picture(BufReader::new(File::open(file).ok()?), limits).ok()?;
    let picture = DynamicImage::from_decoder(decoder).ok()?.into_luma8();
    if !is_usable([picture.width(), picture.height()]) {
        return None;
    }
    let (band_rows, width) = (middle_rows(picture.height()), picture.width() as usize);
    let levels = picture.as_raw()[band_rows.start * width..band_rows.end * width]
        .iter()
        .map(|level| f32::from(*level));
    Some((levels.collect(), width))
}

/// The period of a sequence, if it has a strong one.
fn period(values: &[f64]) -> Option<usize> {
    /// The least share of the variance that the period explains; a shorter one that explains this share of the best
    /// is the true one.
    const EXPLAINED: f64 = 0.35;
    const NEARLY: f64 = 0.85;
    /// The least ratio of the greatest mean of a class to the low ones: for blocks of JPEG it is less than 1.3.
    const STRONG: f64 = 1.6;
    let high = without_trend(values);
    let total: f64 = high.iter().map(|value| value * value).sum();
    if total.is_nan() || total <= 0.0 {
        return None;
    }
    let explained = |period: usize| {
        let means = class_means(&high, period);
        let within: f64 =
            high.iter().enumerate().map(|(at, value)| (value - means[at % period]).powi(2)).sum();
        // Adjusted for the number of free means.
        let (count, free) = (high.len() as f64, period as f64);
        1.0 - within / total * (count - 1.0) / (count - free)
    };
    let candidates: Vec<(usize, f64)> =
        PITCHES.filter(|period| high.len() >= period * 6).map(|period| (period, explained(period))).collect();
    let best = candidates.iter().map(|(_, explained)| *explained).fold(0.0, f64::max);
    let (period, _) = candidates.into_iter().find(|(_, explained)| *explained >= NEARLY * best)?;
    let mut means = class_means(values, period);
    means.sort_by(f64::total_cmp);
    (best >= EXPLAINED && means[period - 1] >= STRONG * means[period / 4]).then_some(period)
}

/// The mean of the values at each phase of a period.
fn class_means(values: &[f64], period: usize) -> Vec<f64> {
    let (mut sums, mut counts) = (vec![0.0; period], vec![0.0f64; period]);
    for (at, value) in values.iter().enumerate() {
        sums[at % period] += value;
        counts[at % period] += 1.0;
    }
    sums.iter().zip(counts).map(|(sum, count)| sum / count.max(1.0)).collect()
}

/// The values relative to their mean over a window around each.
fn without_trend(values: &[f64]) -> Vec<f64> {
    /// Twice the widest pitch, on either side.
    const REACH: usize = 80;
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(values.iter().scan(0.0, |sum, value| {
            *sum += value;
            Some(*sum)
        }))
        .collect();
    let relative = |(at, value): (usize, &f64)| {
        let (start, end) = (at.saturating_sub(REACH), (at + REACH + 1).min(values.len()));
        let mean = (sums[end] - sums[start]) / (end - start) as f64;
        if mean > 0.0 { value / mean - 1.0 } else { 0.0 }
    };
    values.iter().enumerate().map(relative).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn periods_and_what_has_none() {
        let noise = |at: usize| ((at * 7919 + at * at * 31) % 101) as f64 / 101.0;
        let micro = |pitch: usize| -> Vec<f64> {
            (0..700).map(|at| 1.0 + noise(at) + if at % pitch == pitch - 1 { 4.0 } else { 0.0 }).collect()
        };
        for pitch in [3, 7, 14, 15, 33] {
            assert_eq!(period(&micro(pitch)), Some(pitch));
        }
        // Blocks of JPEG; noise; a picture that only grows.
        let blocks: Vec<f64> =
            (0..700).map(|at| 2.0 + 0.2 * noise(at) + if at % 8 == 7 { 0.3 } else { 0.0 }).collect();
        assert_eq!(period(&blocks), None);
        assert_eq!(period(&(0..700).map(noise).collect::<Vec<_>>()), None);
        assert_eq!(period(&(0..700).map(|at| at as f64).collect::<Vec<_>>()), None);
        assert_eq!(period(&[0.0; 700]), None);
    }
}
