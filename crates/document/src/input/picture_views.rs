//! The pictures that a surface was made from, as photographs of it: to look through, and to compare with.

use crate::input::picture_scene::PictureSpace;
use capture::PictureSource;
use glam::{DMat4, DVec2, DVec3};
use lens::{CalibratedLens, Distortion, Intrinsics, Projection};
use scene::View;

/// A picture as a photograph, taken from `position` in the aperture (steps to the right and downward). Points of disparity 0 are where the
/// centre picture has them. `None` if the picture is not a file of its own.
pub(crate) fn picture_view(
    name: &str,
    picture: &PictureSource,
    position: DVec2,
    size_px: [u32; 2],
    space: &PictureSpace,
) -> Option<View> {
    let PictureSource::File { file, orientation } = picture else { return None };
    let principal = DVec2::new(f64::from(size_px[0]), f64::from(size_px[1])) / 2.0 + position * space.offset;
    let intrinsics = Intrinsics {
        size_px,
        focal_px: [space.focal_px; 2],
        skew_px: 0.0,
        principal_px: principal.to_array(),
    };
    let camera_position = DVec3::new(position.x, -position.y, 0.0) * space.baseline();
    Some(View {
        name: name.into(),
        picture: file.clone(),
        orientation: *orientation,
        exif_orientation: 1,
        lens: CalibratedLens::new(intrinsics, Projection::Perspective, Distortion::default()).ok()?,
        camera_to_world: DMat4::from_translation(camera_position),
        mask: None,
        exposure_hint: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disparities_project_to_their_shifted_positions() {
        let space = PictureSpace { focal_px: 120.0, offset: 1.5, scale: 4.0 };
        let picture = PictureSource::File { file: "a.png".into(), orientation: 1 };
        let view = |position| picture_view("a", &picture, position, [80, 60], &space).unwrap();
        for disparity in [-1.0, 0.0, 2.0] {
            // The point that the centre picture shows at (50, 20).
            let z = 1.0 / space.inverse_depth(disparity);
            let point = DVec3::new(10.0, 10.0, -120.0) * (z / 120.0);
            assert!(view(DVec2::ZERO).project(point).unwrap().distance(DVec2::new(50.0, 20.0)) < 1e-9);
            let position = DVec2::new(2.0, -1.0);
            let moved = DVec2::new(50.0, 20.0) - position * disparity;
            assert!(view(position).project(point).unwrap().distance(moved) < 1e-9);
        }
    }
}
