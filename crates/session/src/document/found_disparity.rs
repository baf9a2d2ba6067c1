//! Disparities of a light field that came without: found in its views; or with a map that is coded by colour: decoded by them.

use crate::error::SessionError;
use crate::kept_files::KeptFiles;
use ::disparity::colour_coded::{Sample, decode};
use ::disparity::{Asked, DisparityError, Picture, View};
use capture::{LightField, PictureSource};
use glam::DVec2;
use progress::{Progress, Stage};
use scene::{LoadOptions, Photograph, srgb_from_linear};
use sha2::Digest;
use std::path::Path;

/// Pixels of all views together that are looked at: some 12 bytes each as they are read, and about as much in work. Of more, views are
/// left out.
const MOST_PIXELS: usize = 24_000_000;
/// So many views are looked at, however large they are.
const FEWEST: usize = 5;

/// Pixels of a map that is coded by colour are told where the views tell their disparity this surely.
const SURE: f32 = 0.5;
/// As many of them are enough, spread over the picture.
const SAMPLES: usize = 4000;

/// Eight bytes a pixel: disparities, then how surely each is told.
const FILES: KeptFiles = KeptFiles { name: "disparities", budget_bytes: 512 << 20 };

/// Disparities of the middle view, and how surely each is told, in [0, 1].
struct Told {
    disparity: Vec<f32>,
    confidence: Vec<f32>,
}

/// The disparities of the middle view.
pub(super) fn found_disparity(
    field: &LightField,
    load: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Vec<f32>, SessionError> {
    let told = told(field, load, &Stage::new(progress, 0.0, 0.9))?;
    match &field.coded_disparity {
        Some(coded) => decoded(field, &coded.photograph(load)?, &told, &Stage::new(progress, 0.9, 1.0)),
        None => Ok(told.disparity),
    }
}

/// A map that is coded by colour, decoded by what the views tell surely; at the size of the views.
fn decoded(
    field: &LightField,
    coded: &Photograph,
    told: &Told,
    progress: &dyn Progress,
) -> Result<Vec<f32>, SessionError> {
    let [width, height] = field.size.map(|side| side as usize);
    let [columns, rows] = [coded.width, coded.height].map(|side| side as usize);
    let rgb: Vec<[f32; 3]> = coded.pixels.iter().map(|rgb| rgb.map(shown)).collect();
    let sure: Vec<usize> = (0..width * height).filter(|&pixel| told.confidence[pixel] >= SURE).collect();
    // The pixel of the map at a pixel's middle.
    let place = |pixel: usize| {
        let middle = |at: usize, of: usize, to: usize| (2 * at + 1) * to / (2 * of);
        [middle(pixel % width, width, columns), middle(pixel / width, height, rows)]
    };
    let samples = sure.iter().step_by(sure.len().div_ceil(SAMPLES).max(1)).map(|&pixel| {
        let [x, y] = place(pixel);
        Sample { x, y, disparity: told.disparity[pixel] }
    });
    let map = Picture { width: columns, height: rows, rgb: &rgb };
    let decoded = decode(&map, &samples.collect::<Vec<_>>(), progress);
    let file = field.coded_disparity.as_ref().map_or(field.path.as_path(), PictureSource::file);
    let decoded = decoded.map_err(|error| disparity_error(file, error))?;
    let at = |pixel: usize| {
        let [x, y] = place(pixel);
        decoded.disparity[y * columns + x]
    };
    Ok((0..width * height).map(at).collect())
}

fn disparity_error(file: &Path, error: DisparityError) -> SessionError {
    match error {
        DisparityError::Cancelled(_) => SessionError::Cancelled,
        other => SessionError::bad(file, format!("tells no disparities: {other}")),
    }
}

/// As a screen shows it, up to white.
fn shown(linear: f32) -> f32 {
    srgb_from_linear(linear.clamp(0.0, 1.0))
}

/// What the views tell: found before, or now.
fn told(field: &LightField, load: &LoadOptions, progress: &dyn Progress) -> Result<Told, SessionError> {
    let [width, height] = field.size.map(|side| side as usize);
    let most = (MOST_PIXELS / (width * height).max(1)).max(FEWEST);
    let places: Vec<DVec2> = field.views.iter().map(|view| view.position).collect();
    let chosen = spread(&places, field.reference, most);
    let file = FILES.file(|hash| {
        for &number in &chosen {
            let view = &field.views[number];
            // A picture is taken for the same where file, size and time of change are.
            let data = std::fs::metadata(view.picture.file()).map(|data| (data.len(), data.modified().ok()));
            hash.update(format!("{:?} {} {:?}", view.picture, view.position, data.ok()));
        }
        let range = field.optics.disparity_range;
        hash.update(format!("{} {:?} {} {range:?}", ::disparity::VERSION, field.size, field.reference));
    });
    let kept = file.as_ref().and_then(|file| FILES.read(file));
    if let Some(kept) = kept.filter(|bytes| bytes.len() == 8 * width * height) {
        let numbers =
            |bytes: &[u8]| bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        let (disparity, confidence) = kept.split_at(4 * width * height);
        return Ok(Told { disparity: numbers(disparity), confidence: numbers(confidence) });
    }
    let mut pictures = Vec::with_capacity(chosen.len());
    for (done, &number) in chosen.iter().enumerate() {
        progress.check()?;
        progress.report(0.3 * done as f32 / chosen.len() as f32);
        let picture = field.views[number].picture.photograph(load)?;
        pictures.push(picture.pixels.into_iter().map(|rgb| rgb.map(shown)).collect::<Vec<_>>());
    }
    let views: Vec<View<'_>> = chosen
        .iter()
        .zip(&pictures)
        .map(|(&number, rgb)| View {
            picture: Picture { width, height, rgb },
            position: places[number].to_array(),
        })
        .collect();
    let reference = chosen.iter().position(|&number| number == field.reference).unwrap_or(0);
    let range = field.optics.disparity_range.map(|[low, high]| (low as f32, high as f32));
    let asked = Asked { reference, range, ..Asked::default() };
    let found = ::disparity::find(&views, &asked, &Stage::new(progress, 0.3, 1.0));
    let found = found.map_err(|error| disparity_error(&field.path, error))?.swap_remove(0);
    if let Some(file) = file {
        let numbers = found.disparity.iter().chain(&found.confidence);
        FILES.write(&file, &numbers.flat_map(|number| number.to_le_bytes()).collect::<Vec<_>>());
    }
    Ok(Told { disparity: found.disparity, confidence: found.confidence })
}

/// At most so many of the places, the first that of `start`, then always the one farthest from those that were chosen.
fn spread(places: &[DVec2], start: usize, most: usize) -> Vec<usize> {
    let mut far: Vec<f64> = places.iter().map(|place| place.distance_squared(places[start])).collect();
    let mut chosen = vec![start];
    while chosen.len() < most.min(places.len()) {
        let farthest = (0..places.len()).max_by(|&a, &b| far[a].total_cmp(&far[b])).unwrap_or(start);
        if far[farthest] == 0.0 {
            break;
        }
        chosen.push(farthest);
        for (far, place) in far.iter_mut().zip(places) {
            *far = far.min(place.distance_squared(places[farthest]));
        }
    }
    chosen.sort_unstable();
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_that_are_looked_at_are_spread() {
        let places: Vec<DVec2> =
            (0..25).map(|k| DVec2::new((k % 5) as f64 - 2.0, (k / 5) as f64 - 2.0)).collect();
        assert_eq!(spread(&places, 12, 100), (0..25).collect::<Vec<_>>());
        assert_eq!(spread(&places, 12, 5), [0, 4, 12, 20, 24]);
        assert_eq!(spread(&[DVec2::ZERO; 3], 1, 3), [1]);
    }
}
