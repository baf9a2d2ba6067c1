//! A picture and its depth as a scene.

use crate::input::picture_surface::PictureSurface;
use crate::input::picture_surface::check_size;
use crate::input::picture_surface::default_focal_px;
use crate::input::picture_surface::finite_range;
use crate::input::picture_surface::margin_px;
use crate::input::picture_surface::relief_error;
use crate::input::picture_surface::show_early_picture;
use crate::input::picture_scene::PictureSpace;
use crate::input::picture_scene::SourcePicture;
use crate::input::picture_scene::SurfaceSource;
use crate::input::picture_scene::picture_camera;
use crate::input::picture_scene::picture_scene;
use crate::input::picture_scene::uncalibrated_space;
use crate::input::picture_views::picture_view;
use crate::error::DocumentError;
use crate::error::file_name;
use light::Steps;
use capture::{CaptureError, DepthMeaning, DepthPictureOptions};
use glam::DVec2;
use lens::Camera;
use progress::Stage;
use relief::{DepthStroke, Relief, ReliefOptions, apply_depth_strokes, fill_unknown_disparity, upsample};
use std::path::Path;

/// What is infinitely far, or as good as, is put at so many times the nearest distance.
const MAX_DISTANCE_RATIO: f32 = 1000.0;
/// A surface of more cells than this is made coarser than its picture, which stays as fine as it is.
const MAX_CELLS: u64 = 4_200_000;
/// The f-number that the surface is made for: behind what stands before something it goes on as far as this aperture looks.
const WIDEST_F_NUMBER: f64 = 1.0;

/// Cells of so many pixels each way.
fn cell_count([width, height]: [u32; 2], cell_px: u32) -> u64 {
    u64::from(width.div_ceil(cell_px)) * u64::from(height.div_ceil(cell_px))
}

/// Opens a picture with its depth and makes its surface.
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
            "says of no pixel how far it is (give another map)",
        ));
    }
    let focal_px =
        depth_picture.focal_px.unwrap_or_else(|| default_focal_px(depth_picture.size)) / f64::from(cell_px);
    let space = match depth_picture.depth.meaning {
        DepthMeaning::Distance => {
            let nearest = disparity.iter().copied().fold(0.0, f32::max);
            if !(nearest > 0.0 && nearest.is_finite()) {
                let what = "says of no pixel how far it is in metres (give another map)";
                return Err(DocumentError::bad_file(&depth_picture.depth_file, what));
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
    // Seen as fine as it is, though the surface may be coarser.
    let full_space = PictureSpace { focal_px: space.focal_px * f64::from(cell_px), ..space };
    scene.excluded_views.extend(picture_view(
        &depth_picture.name,
        &depth_picture.picture,
        DVec2::ZERO,
        depth_picture.size,
        &full_space,
    ));
    // At first half as wide as it may be.
    let camera = picture_camera(&scene, depth_picture.size, &space, reach_steps / 2.0);
    let is_incomplete = depth_picture.remarks.iter().any(|remark| remark.is_incomplete);
    let remarks = depth_picture.remarks.into_iter().map(|remark| remark.text).collect();
    Ok(PictureSurface { scene, camera, remarks, is_incomplete })
}
