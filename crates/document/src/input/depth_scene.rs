//! Pictures with depth as scenes.

use crate::error::{DocumentError, file_name};
use crate::input::picture_scene::{
    PictureSpace, SourcePicture, SurfaceSource, picture_camera, picture_scene, uncalibrated_space,
};
use crate::input::picture_surface::{
    PictureSurface, check_size, default_focal_px, finite_range, margin_px, relief_error, show_early_picture,
};
use crate::input::picture_views::picture_view;
use capture::{CaptureError, DepthMeaning, DepthPictureOptions};
use glam::DVec2;
use lens::Camera;
use light::Steps;
use progress::Stage;
use relief::{DepthStroke, Relief, ReliefOptions, apply_depth_strokes, fill_unknown_disparity, upsample};
use std::path::Path;

/// Distances, which may be infinite, are limited to this multiple of the nearest.
const MAX_DISTANCE_RATIO: f32 = 1000.0;
/// Maximum number of cells of a surface; beyond it, the surface is coarser than its picture, whose resolution is kept.
const MAX_CELLS: u64 = 4_200_000;
/// The f-number that the surface is made for: behind occluders, it is continued as far as this aperture sees.
const WIDEST_F_NUMBER: f64 = 1.0;

/// The number of cells with sides of `cell_px` pixels.
fn cell_count([width, height]: [u32; 2], cell_px: u32) -> u64 {
    u64::from(width.div_ceil(cell_px)) * u64::from(height.div_ceil(cell_px))
}

/// Opens a picture with its depth, repairs the depth by `strokes`, and makes its surface.
pub(crate) fn load_depth_picture(
    path: &Path,
    options: &DepthPictureOptions,
    strokes: &[DepthStroke],
    steps: &dyn Steps,
) -> Result<PictureSurface, DocumentError> {
    let progress = &*steps.begin("reading");
    let depth_picture = capture::open_depth_picture(path, options)?;
    let photograph = check_size(depth_picture.picture.photograph(&options.load)?, depth_picture.size, path)?;
    show_early_picture(&photograph, steps);
    let cell_px =
        (1..).find(|candidate_px| cell_count(depth_picture.size, *candidate_px) <= MAX_CELLS).unwrap_or(1);
    let size = depth_picture.size.map(|side| side.div_ceil(cell_px) as usize);
    let reduced_pixels = if cell_px > 1 { photograph.downsampled(cell_px).pixels } else { Vec::new() };
    let picture = if cell_px > 1 { &reduced_pixels } else { &photograph.pixels };
    progress.check()?;
    let map_size = [depth_picture.depth.width as usize, depth_picture.depth.height as usize];
    let mut disparity =
        fill_unknown_disparity(size, upsample(map_size, &depth_picture.depth.inverse_depth(), size, picture));
    if disparity.first().is_none_or(|value| value.is_nan()) {
        return Err(DocumentError::bad_file(
            &depth_picture.depth_file,
            "contains no depth (choose another depth map)",
        ));
    }
    let focal_px =
        depth_picture.focal_px.unwrap_or_else(|| default_focal_px(depth_picture.size)) / f64::from(cell_px);
    let space = match depth_picture.depth.meaning {
        DepthMeaning::Distance => {
            let nearest = disparity.iter().copied().fold(0.0, f32::max);
            if !(nearest > 0.0 && nearest.is_finite()) {
                let message = "contains no distance in metres (choose another depth map)";
                return Err(DocumentError::bad_file(&depth_picture.depth_file, message));
            }
            disparity.iter_mut().for_each(|value| *value = value.max(nearest / MAX_DISTANCE_RATIO));
            PictureSpace { focal_px, offset: 0.0, scale: 1.0 }
        }
        DepthMeaning::Disparity | DepthMeaning::Relative => {
            uncalibrated_space(finite_range(&disparity), focal_px)
        }
    };
    let sensor_height = Camera::default().sensor_height;
    let focal_length = sensor_height * focal_px * f64::from(cell_px) / f64::from(depth_picture.size[1]);
    let max_aperture_radius = focal_length / (2.0 * WIDEST_F_NUMBER);
    let reach_steps = max_aperture_radius / space.baseline();
    let [low, high] = finite_range(&disparity);
    let surface = ReliefOptions {
        reach: reach_steps as f32,
        offset: space.offset as f32,
        margin_px: margin_px(size, reach_steps * (high - low)),
        ..ReliefOptions::default()
    };
    let stage = Stage::new(progress, 0.2, 1.0);
    let disparity = apply_depth_strokes(size, disparity, picture, strokes, cell_px as f32);
    let relief = Relief::build::<CaptureError>(size, &disparity, picture, &[], &surface, &stage)
        .map_err(relief_error)?;
    let center_disparity = disparity[size[1] / 2 * size[0] + size[0] / 2];
    let [width, height] = depth_picture.size;
    let quantity = match depth_picture.depth.meaning {
        DepthMeaning::Distance => "distances",
        DepthMeaning::Disparity => "disparities",
        DepthMeaning::Relative => "relative depth",
    };
    let origin = format!("{width} × {height} px, {quantity} of {}", file_name(&depth_picture.depth_file));
    let source = SurfaceSource { name: &depth_picture.name, path, origin };
    let source_picture = SourcePicture {
        pixels: &photograph.pixels,
        size: depth_picture.size.map(|side| side as usize),
        cell_px: cell_px as usize,
    };
    let mut scene = picture_scene(&relief, &source_picture, &space, &source, f64::from(center_disparity));
    // The picture has its full resolution here, though the surface may be coarser.
    let full_space = PictureSpace { focal_px: space.focal_px * f64::from(cell_px), ..space };
    scene.excluded_views.extend(picture_view(
        &depth_picture.name,
        &depth_picture.picture,
        DVec2::ZERO,
        depth_picture.size,
        &full_space,
    ));
    // The initial aperture is half as wide as the surface allows.
    let camera = picture_camera(&scene, depth_picture.size, &space, reach_steps / 2.0);
    let is_incomplete = depth_picture.remarks.iter().any(|remark| remark.is_incomplete);
    let remarks = depth_picture.remarks.into_iter().map(|remark| remark.text).collect();
    Ok(PictureSurface { scene, camera, remarks, is_incomplete })
}
