//! Light fields as scenes: the centre view on a surface made from disparities, and behind it what the other views see.

use crate::error::{DocumentError, file_name};
use crate::input::disparity_estimate::estimate_disparity;
use crate::input::picture_scene::{
    PictureSpace, SourcePicture, SurfaceSource, picture_camera, picture_scene, uncalibrated_space,
};
use crate::input::picture_surface::{
    PictureSurface, check_size, default_focal_px, finite_range, margin_px, relief_error, show_early_picture,
};
use crate::input::picture_views::picture_view;
use capture::{CaptureError, LightField, LightFieldOptions, Optics, ViewDisparity};
use light::{DiskCache, Steps};
use progress::Stage;
use relief::{
    DepthStroke, OtherView, Relief, ReliefOptions, apply_depth_strokes, fill_unknown_disparity,
    measure_roughness, upsample,
};
use std::path::Path;

/// Cameras and apertures may reach this multiple of the farthest view's distance from the centre view.
const CAMERA_REACH_FACTOR: f64 = 1.6;
/// Disparities with less roughness than this, as parallax in px, are smooth: small jumps in them are not noise.
const SMOOTH_PX: f32 = 0.03;

/// Opens a light field, repairs its depth by `strokes`, and makes its surface.
pub(crate) fn load_light_field(
    path: &Path,
    options: &LightFieldOptions,
    strokes: &[DepthStroke],
    cache: &DiskCache,
    steps: &dyn Steps,
) -> Result<PictureSurface, DocumentError> {
    let progress = &*steps.begin("reading");
    let field = capture::open_light_field(path, options, &Stage::new(progress, 0.0, 0.1))?;
    let size = field.size.map(|side| side as usize);
    let load = &options.load;
    let photograph = check_size(field.views[field.reference].picture.photograph(load)?, field.size, path)?;
    show_early_picture(&photograph, steps);
    let middle_pixels = photograph.pixels;
    let disparity = match provided_disparity(&field) {
        Some(provided) => dense_disparity(provided, size, &middle_pixels),
        None => estimate_disparity(&field, load, cache, &Stage::new(progress, 0.1, 0.5))?,
    };
    let reach = field.views.iter().map(|view| view.position.length()).fold(0.0, f64::max);
    let range = finite_range(&disparity);
    let roughness_px = measure_roughness(size, &disparity) * reach as f32;
    let disparity = apply_depth_strokes(size, disparity, &middle_pixels, strokes, 1.0);
    let space = picture_space(&field.optics, field.size, range);
    let surface = ReliefOptions {
        reach: reach as f32,
        beyond: CAMERA_REACH_FACTOR as f32,
        offset: space.offset as f32,
        jump_px: if roughness_px < SMOOTH_PX { 0.5 } else { ReliefOptions::default().jump_px },
        // Blur reaches as far as the parallax relative to the focus plane; a camera that moves sees beyond the picture's edges by the parallax of
        // the nearest point.
        margin_px: margin_px(
            size,
            CAMERA_REACH_FACTOR * reach * (range[1] - range[0]).max(range[1] + space.offset),
        ),
        ..ReliefOptions::default()
    };
    let other_views = field.views.iter().enumerate().filter(|(number, _)| *number != field.reference);
    let other_views: Vec<OtherView<'_, CaptureError>> = other_views
        .map(|(_, view)| OtherView {
            offset: view.position.as_vec2().to_array(),
            read: Box::new(move || Ok(view.picture.photograph(load)?.pixels)),
        })
        .collect();
    let stage = Stage::new(progress, 0.5, 1.0);
    let relief = Relief::build(size, &disparity, &middle_pixels, &other_views, &surface, &stage)
        .map_err(relief_error)?;
    // The views agree at disparity 0: the camera that took them was focused there.
    let focus = if (range[0]..=range[1]).contains(&0.0) { 0.0 } else { 0.5 * (range[0] + range[1]) };
    let source_picture = SourcePicture { pixels: &middle_pixels, size, cell_px: 1 };
    let disparity_origin = match provided_disparity(&field) {
        Some(provided) => format!("of {}", file_name(&provided.file)),
        None if field.coded_disparity.is_some() => "decoded from their colours".into(),
        None => "estimated from them".into(),
    };
    let ([width, height], [low, high]) = (size, range);
    let views = field.views.len();
    let origin = format!(
        "{views} views of {width} × {height} px, disparities {low:.2} to {high:.2} px per step, {disparity_origin}"
    );
    let source = SurfaceSource { name: &field.name, path, origin };
    let mut scene = picture_scene(&relief, &source_picture, &space, &source, focus);
    let views = field.views.iter();
    let views =
        views.filter_map(|view| picture_view(&view.name, &view.picture, view.position, field.size, &space));
    scene.excluded_views = views.collect();
    let mut camera = picture_camera(&scene, field.size, &space, reach);
    if let Some(longer_mm) = field.optics.sensor_size_mm {
        let [width, height] = field.size.map(f64::from);
        camera.sensor_height = longer_mm * 1e-3 * height / width.max(height);
    }
    let is_incomplete = field.remarks.iter().any(|remark| remark.is_incomplete);
    let remarks = field.remarks.into_iter().map(|remark| remark.text).collect();
    Ok(PictureSurface { scene, camera, remarks, is_incomplete })
}

/// The disparities of the centre view that came with the light field.
fn provided_disparity(field: &LightField) -> Option<&ViewDisparity> {
    field.disparity.as_ref().filter(|disparity| disparity.view == field.reference)
}

/// A disparity for each pixel of the centre view, from a map that may be smaller and have gaps.
fn dense_disparity(provided: &ViewDisparity, size: [usize; 2], middle_pixels: &[[f32; 3]]) -> Vec<f32> {
    let map_size = [provided.map.width as usize, provided.map.height as usize];
    let sparse_disparity = upsample(map_size, &provided.map.inverse_depth(), size, middle_pixels);
    fill_unknown_disparity(size, sparse_disparity)
}

/// How disparities become distances: by the optics in the files, if that puts all points in front of the camera.
fn picture_space(optics: &Optics, size: [u32; 2], range: [f64; 2]) -> PictureSpace {
    let longer = f64::from(size[0].max(size[1]));
    let focal_px = optics.focal_length_mm.zip(optics.sensor_size_mm).map(|(f, s)| f * longer / s);
    let fallback = uncalibrated_space(range, focal_px.unwrap_or_else(|| default_focal_px(size)));
    let (Some(focal_px), Some(baseline), Some(focus)) =
        (focal_px, optics.baseline_mm, optics.focus_distance_m)
    else {
        return fallback;
    };
    let scale = focal_px * baseline * 1e-3;
    let calibrated = PictureSpace { focal_px, scale, offset: scale / focus };
    if calibrated.inverse_depth(range[0]) > 0.0 { calibrated } else { fallback }
}
