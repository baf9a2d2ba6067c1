//! Disparities of a light field that came without: found in its views.

use crate::error::SessionError;
use crate::kept_files::KeptFiles;
use ::disparity::{Asked, DisparityError, Picture, View};
use capture::LightField;
use glam::DVec2;
use progress::{Progress, Stage};
use scene::{LoadOptions, srgb_from_linear};
use sha2::Digest;

/// Pixels of all views together that are looked at: some 12 bytes each as they are read, and about as much in work. Of more, views are
/// left out.
const MOST_PIXELS: usize = 24_000_000;
/// So many views are looked at, however large they are.
const FEWEST: usize = 5;

/// Four bytes a pixel.
const FILES: KeptFiles = KeptFiles { name: "disparities", budget_bytes: 512 << 20 };

/// The disparities of the middle view: found before, or now.
pub(super) fn found_disparity(
    field: &LightField,
    load: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Vec<f32>, SessionError> {
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
        hash.update(format!("{:?} {} {:?}", field.size, field.reference, field.optics.disparity_range));
    });
    let kept = file.as_ref().and_then(|file| FILES.read(file));
    if let Some(kept) = kept.filter(|bytes| bytes.len() == 4 * width * height) {
        return Ok(kept.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect());
    }
    let mut pictures = Vec::with_capacity(chosen.len());
    for (done, &number) in chosen.iter().enumerate() {
        progress.check()?;
        progress.report(0.3 * done as f32 / chosen.len() as f32);
        let shown = field.views[number].picture.photograph(load)?;
        pictures.push(
            shown
                .pixels
                .into_iter()
                .map(|rgb| rgb.map(|linear| srgb_from_linear(linear.clamp(0.0, 1.0))))
                .collect::<Vec<_>>(),
        );
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
    let mut maps =
        ::disparity::find(&views, &asked, &Stage::new(progress, 0.3, 1.0)).map_err(|error| match error {
            DisparityError::Cancelled(_) => SessionError::Cancelled,
            other => SessionError::bad(&field.path, format!("no depth is found in its views: {other}")),
        })?;
    let found = maps.swap_remove(0).disparity;
    if let Some(file) = file {
        FILES.write(&file, &found.iter().flat_map(|disparity| disparity.to_le_bytes()).collect::<Vec<_>>());
    }
    Ok(found)
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
