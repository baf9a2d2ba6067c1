//! A light field as a scene: its middle view, a surface from disparities, and behind it what the other views see.

use super::found_disparity::found_disparity;
use super::of_picture::{OfPicture, margin_px, of_size, range, relief_error, show, usual_focal_px};
use super::picture_scene::{Named, PictureSpace, Shown, picture_camera, picture_scene, uncalibrated};
use super::picture_views::picture_view;
use crate::error::{SessionError, file_name};
use crate::jobs::Steps;
use capture::{CaptureError, GivenDisparity, LightField, LightFieldOptions, Optics};
use progress::{Progress, Stage};
use relief::{DepthStroke, OtherView, Relief, ReliefOptions, filled, repaired, roughness, upsampled};
use scene::LoadOptions;
use std::path::Path;

/// Cameras may stand, and apertures reach, so many times as far from the middle view as the farthest view.
const BEYOND: f64 = 1.6;
/// Disparities are even that are rougher by no more than this, as a parallax, px: they have smaller jumps, which noise has not made.
const EVEN_PX: f32 = 0.03;

/// Opens a light field and makes its surface, the depth of which is repaired by `strokes`.
pub(super) fn load_light_field(
    path: &Path,
    options: &LightFieldOptions,
    strokes: &[DepthStroke],
    steps: &dyn Steps,
) -> Result<OfPicture, SessionError> {
    let progress = &*steps.begin("reading");
    let field = capture::open_light_field(path, options, &Stage::new(progress, 0.0, 0.1))?;
    let size = field.size.map(|side| side as usize);
    let load = &options.load;
    let middle = of_size(field.views[field.reference].picture.photograph(load)?, field.size, path)?;
    show(&middle, steps);
    let middle = middle.pixels;
    let disparity = disparity(&field, size, &middle, load, &Stage::new(progress, 0.1, 0.5))?;
    let reach = field.views.iter().map(|view| view.position.length()).fold(0.0, f64::max);
    let range = range(&disparity);
    let rough_px = roughness(size, &disparity) * reach as f32;
    let disparity = repaired(size, disparity, &middle, strokes, 1.0);
    let space = space(&field.optics, field.size, range);
    let surface = ReliefOptions {
        reach: reach as f32,
        beyond: BEYOND as f32,
        offset: space.offset as f32,
        jump_px: if rough_px < EVEN_PX { 0.5 } else { ReliefOptions::default().jump_px },
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
    let whence = match given(&field) {
        Some(given) => format!("of {}", file_name(&given.file)),
        None if field.coded_disparity.is_some() => "decoded from their colours".into(),
        None => "found in them".into(),
    };
    let ([width, height], [low, high]) = (size, range);
    let views = field.views.len();
    let origin = format!(
        "{views} views of {width} × {height} px, disparities {low:.2} to {high:.2} px a step, {whence}"
    );
    let named = Named { name: &field.name, path, origin };
    let mut scene = picture_scene(&relief, &shown, &space, &named, focus);
    let views = field.views.iter();
    let views =
        views.filter_map(|view| picture_view(&view.name, &view.picture, view.position, field.size, &space));
    scene.left_out = views.collect();
    let mut camera = picture_camera(&scene, field.size, &space, reach);
    if let Some(longer_mm) = field.optics.sensor_size_mm {
        let [width, height] = field.size.map(f64::from);
        camera.sensor_height = longer_mm * 1e-3 * height / width.max(height);
    }
    let is_incomplete = field.remarks.iter().any(|remark| remark.is_incomplete);
    let remarks = field.remarks.into_iter().map(|remark| remark.text).collect();
    Ok(OfPicture { scene, camera, remarks, is_incomplete })
}

/// The disparities of the middle view that came along.
fn given(field: &LightField) -> Option<&GivenDisparity> {
    field.disparity.as_ref().filter(|given| given.view == field.reference)
}

/// The disparity of each pixel of the middle view: as it is given, else found in the views.
fn disparity(
    field: &LightField,
    size: [usize; 2],
    middle: &[[f32; 3]],
    load: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Vec<f32>, SessionError> {
    let Some(given) = given(field) else { return found_disparity(field, load, progress) };
    let map = [given.map.width as usize, given.map.height as usize];
    let known = upsampled(map, &given.map.inverse_depth(), size, middle);
    Ok(filled(size, known))
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
