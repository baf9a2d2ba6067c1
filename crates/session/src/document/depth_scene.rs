//! A picture and its depth as a scene.

use super::of_picture::{OfPicture, margin_px, of_size, range, relief_error, show, usual_focal_px};
use super::picture_scene::{Named, PictureSpace, Shown, picture_camera, picture_scene, uncalibrated};
use super::picture_views::picture_view;
use crate::error::{SessionError, file_name};
use crate::jobs::Steps;
use capture::{CaptureError, DepthMeaning, DepthPictureOptions};
use glam::DVec2;
use lens::Camera;
use progress::Stage;
use relief::{DepthStroke, Relief, ReliefOptions, filled, repaired, upsampled};
use std::path::Path;

/// What is infinitely far, or as good as, is put at so many times the nearest distance.
const FARTHEST: f32 = 1000.0;
/// A surface of more cells than this is made coarser than its picture, which stays as fine as it is.
const MOST_CELLS: u64 = 4_200_000;
/// The f-number that the surface is made for: behind what stands before something it goes on as far as this aperture looks.
const WIDEST: f64 = 1.0;

/// Cells of so many pixels each way.
fn cells([width, height]: [u32; 2], by: u32) -> u64 {
    u64::from(width.div_ceil(by)) * u64::from(height.div_ceil(by))
}

/// Opens a picture with its depth and makes its surface.
pub(super) fn load_depth_picture(
    path: &Path,
    options: &DepthPictureOptions,
    strokes: &[DepthStroke],
    steps: &dyn Steps,
) -> Result<OfPicture, SessionError> {
    let progress = &*steps.begin("reading");
    let found = capture::open_depth_picture(path, options)?;
    let whole = of_size(found.picture.photograph(&options.load)?, found.size, path)?;
    show(&whole, steps);
    let by = (1..).find(|by| cells(found.size, *by) <= MOST_CELLS).unwrap_or(1);
    let size = found.size.map(|side| side.div_ceil(by) as usize);
    let coarse = if by > 1 { whole.reduced(by).pixels } else { Vec::new() };
    let picture = if by > 1 { &coarse } else { &whole.pixels };
    progress.check()?;
    let map = [found.depth.width as usize, found.depth.height as usize];
    let mut disparity = filled(size, upsampled(map, &found.depth.inverse_depth(), size, picture));
    if disparity.first().is_none_or(|value| value.is_nan()) {
        return Err(SessionError::bad(
            &found.depth_file,
            "says of no pixel how far it is (give another map)",
        ));
    }
    let focal_px = found.focal_px.unwrap_or_else(|| usual_focal_px(found.size)) / f64::from(by);
    let space = match found.depth.meaning {
        DepthMeaning::Distance => {
            let nearest = disparity.iter().copied().fold(0.0, f32::max);
            if !(nearest > 0.0 && nearest.is_finite()) {
                let what = "says of no pixel how far it is in metres (give another map)";
                return Err(SessionError::bad(&found.depth_file, what));
            }
            disparity.iter_mut().for_each(|value| *value = value.max(nearest / FARTHEST));
            PictureSpace { focal_px, offset: 0.0, scale: 1.0 }
        }
        DepthMeaning::Disparity | DepthMeaning::Relative => uncalibrated(range(&disparity), focal_px),
    };
    let sensor_height = Camera::default().sensor_height;
    let focal_length = sensor_height * focal_px * f64::from(by) / f64::from(found.size[1]);
    let widest = focal_length / (2.0 * WIDEST);
    let reach = widest / space.baseline();
    let [low, high] = range(&disparity);
    let surface = ReliefOptions {
        reach: reach as f32,
        offset: space.offset as f32,
        margin_px: margin_px(size, reach * (high - low)),
        ..ReliefOptions::default()
    };
    let stage = Stage::new(progress, 0.2, 1.0);
    let disparity = repaired(size, disparity, picture, strokes, by as f32);
    let relief =
        Relief::of::<CaptureError>(size, &disparity, picture, &[], &surface, &stage).map_err(relief_error)?;
    let middle = disparity[size[1] / 2 * size[0] + size[0] / 2];
    let [width, height] = found.size;
    let what = match found.depth.meaning {
        DepthMeaning::Distance => "distances",
        DepthMeaning::Disparity => "disparities",
        DepthMeaning::Relative => "relative depth",
    };
    let origin = format!("{width} × {height} px, {what} of {}", file_name(&found.depth_file));
    let named = Named { name: &found.name, path, origin };
    let shown = Shown { pixels: &whole.pixels, size: found.size.map(|side| side as usize), by: by as usize };
    let mut scene = picture_scene(&relief, &shown, &space, &named, f64::from(middle));
    // Seen as fine as it is, though the surface may be coarser.
    let fine = PictureSpace { focal_px: space.focal_px * f64::from(by), ..space };
    scene.left_out.extend(picture_view(&found.name, &found.picture, DVec2::ZERO, found.size, &fine));
    // At first half as wide as it may be.
    let camera = picture_camera(&scene, found.size, &space, reach / 2.0);
    let is_incomplete = found.remarks.iter().any(|remark| remark.is_incomplete);
    let remarks = found.remarks.into_iter().map(|remark| remark.text).collect();
    Ok(OfPicture { scene, camera, remarks, is_incomplete })
}
