//! A camera of the scene as the shot camera.

use glam::DVec2;
use lens::Camera;
use scene::SceneCamera;

/// A camera of the scene with the size, lens and background of `lens`, as far as the file says nothing of them.
///
/// Where the camera says its aspect, the width follows it. The lens keeps its numbers: they are lengths of a
/// real camera, whatever the scene.
pub fn camera_of(camera: &SceneCamera, lens: &Camera) -> Camera {
    let width = camera.aspect.map_or(lens.width, |aspect| {
        (lens.height as f64 * aspect).round().clamp(1.0, Camera::LARGEST_SIDE_PX as f64) as u32
    });
    camera.lens.of(Camera {
        width,
        yfov: camera.yfov,
        focus_distance: camera.focus_distance,
        camera_to_world: camera.camera_to_world,
        shift: DVec2::ZERO,
        ..lens.clone()
    })
}
