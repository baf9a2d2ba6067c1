//! A light field as a scene: its middle view, a surface from disparities, and behind it what the other views see.

use super::found_disparity::found_disparity;
use super::picture_scene::{Named, PictureSpace, Shown, picture_camera, picture_scene, uncalibrated};
use crate::error::SessionError;
use capture::{CaptureError, LightField, LightFieldOptions, Optics};
use lens::Camera;
use progress::{Progress, Stage};
use relief::{OtherView, Relief, ReliefError, ReliefOptions, filled, upsampled};
use scene::{LoadOptions, Photograph, Scene};
use std::path::Path;

/// The angle of view across a picture's longer side where no file tells it: that of a lens of 50 mm on a frame of 36.
const LONGER_ANGLE: f64 = 0.6911;

/// Cameras may stand, and apertures reach, so many times as far from the middle view as the farthest view.
const BEYOND: f64 = 1.6;

/// A surface made from one picture, or several of one place.
pub(super) struct OfPicture {
    pub scene: Scene,
    /// The camera of the picture.
    pub camera: Camera,
    /// What is good to know, a sentence each.
    pub remarks: Vec<String>,
    /// Whether something is missing.
    pub is_incomplete: bool,
}

/// Opens a light field and makes its surface.
pub(super) fn load_light_field(
    path: &Path,
    options: &LightFieldOptions,
    progress: &dyn Progress,
) -> Result<OfPicture, SessionError> {
    let field = capture::open_light_field(path, options, &Stage::new(progress, 0.0, 0.1))?;
    let size = field.size.map(|side| side as usize);
    let load = &options.load;
    let middle = of_size(field.views[field.reference].picture.photograph(load)?, field.size, path)?.pixels;
    let disparity = disparity(&field, size, &middle, load, &Stage::new(progress, 0.1, 0.5))?;
    let reach = field.views.iter().map(|view| view.position.length()).fold(0.0, f64::max);
    let range = range(&disparity);
    let space = space(&field.optics, field.size, range);
    let surface = ReliefOptions {
        reach: reach as f32,
        beyond: BEYOND as f32,
        offset: space.offset as f32,
        // Blur reaches as far as parallax does against what is focused on; a camera that moves sees beside the picture as far as what is
        // nearest moves.
        margin_px: margin_px(size, BEYOND * reach * (range[1] - range[0]).max(range[1] + space.offset)),
        ..ReliefOptions::default()
    };
    let others = field.views.iter().enumerate().filter(|(number, _)| *number != field.reference);
    let others: Vec<OtherView<'_, CaptureError>> = others
        .map(|(_, view)| OtherView {
            offset: view.position.as_vec2().to_array(),
            read: Box::new(move || Ok(view.picture.photograph(load)?.pixels)),
        })
        .collect();
    let stage = Stage::new(progress, 0.5, 1.0);
    let relief = Relief::of(size, &disparity, &middle, &others, &surface, &stage).map_err(relief_error)?;
    // What has disparity 0 is where the views agree: the camera that took them was focused there.
    let focus = if (range[0]..=range[1]).contains(&0.0) { 0.0 } else { 0.5 * (range[0] + range[1]) };
    let shown = Shown { pixels: &middle, size, by: 1 };
    let scene = picture_scene(&relief, &shown, &space, &Named { name: &field.name, path }, focus);
    let mut camera = picture_camera(&scene, field.size, &space, reach);
    if let Some(longer_mm) = field.optics.sensor_size_mm {
        let [width, height] = field.size.map(f64::from);
        camera.sensor_height = longer_mm * 1e-3 * height / width.max(height);
    }
    let is_incomplete = field.remarks.iter().any(|remark| remark.is_incomplete);
    let remarks = field.remarks.into_iter().map(|remark| remark.text).collect();
    Ok(OfPicture { scene, camera, remarks, is_incomplete })
}

/// A picture, if it is still of the size that its file had a moment ago.
pub(super) fn of_size(found: Photograph, size: [u32; 2], path: &Path) -> Result<Photograph, SessionError> {
    if [found.width, found.height] == size {
        return Ok(found);
    }
    let what = format!(
        "has changed while it was opened: {} × {} px became {} × {} (open it again)",
        size[0], size[1], found.width, found.height
    );
    Err(SessionError::bad(path, what))
}

/// The disparity of each pixel of the middle view: as it is given, else found in the views.
fn disparity(
    field: &LightField,
    size: [usize; 2],
    middle: &[[f32; 3]],
    load: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Vec<f32>, SessionError> {
    let given = field.disparity.as_ref().filter(|given| given.view == field.reference);
    let Some(given) = given else { return found_disparity(field, load, progress) };
    let map = [given.map.width as usize, given.map.height as usize];
    let known = upsampled(map, &given.map.inverse_depth(), size, middle);
    Ok(filled(size, known))
}

/// How far the surface goes on around the picture for blur of at most this radius, px.
pub(super) fn margin_px(size: [usize; 2], largest_px: f64) -> usize {
    /// Of the shorter side: more would rather be seen as what it is, invented.
    const MOST: f64 = 0.2;
    let most = MOST * size[0].min(size[1]) as f64;
    largest_px.min(most).ceil() as usize
}

/// The least and the greatest.
pub(super) fn range(values: &[f32]) -> [f64; 2] {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    let [low, high] = finite
        .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    if low <= high { [low, high].map(f64::from) } else { [0.0; 2] }
}

/// Focal length in pixels where nothing is known of the lens.
pub(super) fn usual_focal_px(size: [u32; 2]) -> f64 {
    0.5 * f64::from(size[0].max(size[1])) / (0.5 * LONGER_ANGLE).tan()
}

/// How disparities become distances: as the files say, if all of them are then ahead of the camera.
fn space(optics: &Optics, size: [u32; 2], range: [f64; 2]) -> PictureSpace {
    let longer = f64::from(size[0].max(size[1]));
    let focal_px = optics.focal_length_mm.zip(optics.sensor_size_mm).map(|(f, s)| f * longer / s);
    let usual = uncalibrated(range, focal_px.unwrap_or_else(|| usual_focal_px(size)));
    let (Some(focal_px), Some(baseline), Some(focus)) =
        (focal_px, optics.baseline_mm, optics.focus_distance_m)
    else {
        return usual;
    };
    let scale = focal_px * baseline * 1e-3;
    let told = PictureSpace { focal_px, scale, offset: scale / focus };
    if told.inverse_depth(range[0]) > 0.0 { told } else { usual }
}

pub(super) fn relief_error(error: ReliefError<CaptureError>) -> SessionError {
    match error {
        ReliefError::Cancelled(_) => SessionError::Cancelled,
        ReliefError::View(error) => error.into(),
    }
}
