//! Disparities of a light field that came without: estimated from its views, or decoded from a colour-coded map with their help.

use crate::error::DocumentError;
use ::disparity::colour_coded::{Sample, decode};
use ::disparity::{DisparityError, DisparityRequest, Picture, View};
use capture::{LightField, PictureSource};
use glam::DVec2;
use light::{CacheSection, DiskCache};
use progress::{Progress, Stage};
use scene::{LoadOptions, Photograph, srgb_from_linear};
use sha2::Digest;
use std::path::Path;

/// Maximum number of pixels of all views together, which take 12 bytes each when read, and about as much again in work. Views beyond it are
/// left out.
const MAX_TOTAL_PIXELS: usize = 24_000_000;
/// Minimum number of views used, however large they are.
const MIN_VIEWS: usize = 5;

/// Minimum confidence of estimated disparities that are used as samples to decode a colour-coded map.
const MIN_CONFIDENCE: f32 = 0.5;
/// Maximum number of samples, spread over the picture.
const MAX_SAMPLES: usize = 4000;

/// Eight bytes per pixel: all disparities, then all confidences.
const SECTION: CacheSection = CacheSection { name: "disparities", budget_bytes: 512 << 20 };

/// Disparities of the centre view, with their confidences in [0, 1].
struct DisparityEstimate {
    disparity: Vec<f32>,
    confidence: Vec<f32>,
}

/// Estimates the disparities of the centre view, px per step, row by row.
pub(crate) fn estimate_disparity(
    field: &LightField,
    load: &LoadOptions,
    cache: &DiskCache,
    progress: &dyn Progress,
) -> Result<Vec<f32>, DocumentError> {
    let estimate = load_or_estimate(field, load, cache, &Stage::new(progress, 0.0, 0.9))?;
    match &field.coded_disparity {
        Some(coded) => {
            decode_colour_coded(field, &coded.photograph(load)?, &estimate, &Stage::new(progress, 0.9, 1.0))
        }
        None => Ok(estimate.disparity),
    }
}

/// Decodes a colour-coded map with the help of confident estimates; the result has the size of the views.
fn decode_colour_coded(
    field: &LightField,
    coded: &Photograph,
    estimate: &DisparityEstimate,
    progress: &dyn Progress,
) -> Result<Vec<f32>, DocumentError> {
    let [width, height] = field.size.map(|side| side as usize);
    let [columns, rows] = [coded.width, coded.height].map(|side| side as usize);
    let rgb: Vec<[f32; 3]> = coded.pixels.iter().map(|rgb| rgb.map(encode_for_display)).collect();
    let confident_pixels: Vec<usize> =
        (0..width * height).filter(|&pixel| estimate.confidence[pixel] >= MIN_CONFIDENCE).collect();
    // The pixel of the map at a pixel's centre.
    let map_pixel = |pixel: usize| {
        let rescale_index =
            |index: usize, from_len: usize, to_len: usize| (2 * index + 1) * to_len / (2 * from_len);
        [rescale_index(pixel % width, width, columns), rescale_index(pixel / width, height, rows)]
    };
    let samples =
        confident_pixels.iter().step_by(confident_pixels.len().div_ceil(MAX_SAMPLES).max(1)).map(|&pixel| {
            let [x, y] = map_pixel(pixel);
            Sample { x, y, disparity: estimate.disparity[pixel] }
        });
    let map = Picture { width: columns, height: rows, rgb: &rgb };
    let decoded = decode(&map, &samples.collect::<Vec<_>>(), progress);
    let file = field.coded_disparity.as_ref().map_or(field.path.as_path(), PictureSource::file);
    let decoded = decoded.map_err(|error| disparity_failure(file, error))?;
    let disparity_at = |pixel: usize| {
        let [x, y] = map_pixel(pixel);
        decoded.disparity[y * columns + x]
    };
    Ok((0..width * height).map(disparity_at).collect())
}

fn disparity_failure(file: &Path, error: DisparityError) -> DocumentError {
    match error {
        DisparityError::Cancelled(_) => DocumentError::Cancelled,
        other => DocumentError::bad_file(file, format!("disparities cannot be computed: {other}")),
    }
}

/// A linear value in sRGB encoding, clamped to [0, 1].
fn encode_for_display(linear: f32) -> f32 {
    srgb_from_linear(linear.clamp(0.0, 1.0))
}

/// The estimate from the views: read from the cache, or computed.
fn load_or_estimate(
    field: &LightField,
    load: &LoadOptions,
    cache: &DiskCache,
    progress: &dyn Progress,
) -> Result<DisparityEstimate, DocumentError> {
    let [width, height] = field.size.map(|side| side as usize);
    let max_views = (MAX_TOTAL_PIXELS / (width * height).max(1)).max(MIN_VIEWS);
    let positions: Vec<DVec2> = field.views.iter().map(|view| view.position).collect();
    let selected = select_spread_views(&positions, field.reference, max_views);
    let entry = cache.entry(SECTION, |hash| {
        for &number in &selected {
            let view = &field.views[number];
            // Pictures count as equal if their path, size and modification time are.
            let file_stamp = std::fs::metadata(view.picture.file())
                .map(|metadata| (metadata.len(), metadata.modified().ok()));
            hash.update(format!("{:?} {} {:?}", view.picture, view.position, file_stamp.ok()));
        }
        let range = field.optics.disparity_range;
        hash.update(format!("{} {:?} {} {range:?}", ::disparity::VERSION, field.size, field.reference));
    });
    let cached = entry.as_ref().and_then(|entry| entry.read());
    if let Some(cached) = cached.filter(|bytes| bytes.len() == 8 * width * height) {
        let numbers =
            |bytes: &[u8]| bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        let (disparity, confidence) = cached.split_at(4 * width * height);
        return Ok(DisparityEstimate { disparity: numbers(disparity), confidence: numbers(confidence) });
    }
    let mut pictures = Vec::with_capacity(selected.len());
    for (index, &number) in selected.iter().enumerate() {
        progress.check()?;
        progress.report(0.3 * index as f32 / selected.len() as f32);
        let picture = field.views[number].picture.photograph(load)?;
        pictures.push(picture.pixels.into_iter().map(|rgb| rgb.map(encode_for_display)).collect::<Vec<_>>());
    }
    let views: Vec<View<'_>> = selected
        .iter()
        .zip(&pictures)
        .map(|(&number, rgb)| View {
            picture: Picture { width, height, rgb },
            position: positions[number].to_array(),
        })
        .collect();
    let reference = selected.iter().position(|&number| number == field.reference).unwrap_or(0);
    let range = field.optics.disparity_range.map(|[low, high]| (low as f32, high as f32));
    let request = DisparityRequest { reference, range, ..DisparityRequest::default() };
    let result = ::disparity::estimate_disparities(&views, &request, &Stage::new(progress, 0.3, 1.0));
    let result = result.map_err(|error| disparity_failure(&field.path, error))?.swap_remove(0);
    if let Some(entry) = entry {
        let numbers = result.disparity.iter().chain(&result.confidence);
        entry.write(&numbers.flat_map(|number| number.to_le_bytes()).collect::<Vec<_>>());
    }
    Ok(DisparityEstimate { disparity: result.disparity, confidence: result.confidence })
}

/// Selects at most `max_count` well-spread positions by farthest-point sampling from `start`. Returns sorted indices.
fn select_spread_views(positions: &[DVec2], start: usize, max_count: usize) -> Vec<usize> {
    let mut distances_squared: Vec<f64> =
        positions.iter().map(|position| position.distance_squared(positions[start])).collect();
    let mut selected = vec![start];
    while selected.len() < max_count.min(positions.len()) {
        let farthest = (0..positions.len())
            .max_by(|&a, &b| distances_squared[a].total_cmp(&distances_squared[b]))
            .unwrap_or(start);
        if distances_squared[farthest] == 0.0 {
            break;
        }
        selected.push(farthest);
        for (distance_squared, position) in distances_squared.iter_mut().zip(positions) {
            *distance_squared = distance_squared.min(position.distance_squared(positions[farthest]));
        }
    }
    selected.sort_unstable();
    selected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn selected_views_are_spread() {
        let places: Vec<DVec2> =
            (0..25).map(|k| DVec2::new((k % 5) as f64 - 2.0, (k / 5) as f64 - 2.0)).collect();
        assert_eq!(select_spread_views(&places, 12, 100), (0..25).collect::<Vec<_>>());
        assert_eq!(select_spread_views(&places, 12, 5), [0, 4, 12, 20, 24]);
        assert_eq!(select_spread_views(&[DVec2::ZERO; 3], 1, 3), [1]);
    }
}
