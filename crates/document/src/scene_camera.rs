//! Cameras of the scene as shot cameras.

use glam::DVec2;
use lens::Camera;
use scene::SceneCamera;

/// A camera of the scene, with the size, lens and background of `lens` where the file does not specify them.
///
/// If the camera has an aspect ratio, the width follows from it. Lengths of the lens are not scaled: they are those of a real camera,
/// independent of the scene.
pub fn shot_camera_from(camera: &SceneCamera, lens: &Camera) -> Camera {
    let width = camera.aspect.map_or(lens.width, |aspect| {
        (lens.height as f64 * aspect).round().clamp(1.0, Camera::LARGEST_SIDE_PX as f64) as u32
    });
    camera.lens.apply_to(Camera {
        width,
        yfov: camera.yfov,
        focus_distance: camera.focus_distance,
        camera_to_world: camera.camera_to_world,
        shift: DVec2::ZERO,
        ..lens.clone()
    })
}

/// A camera of a scene of unknown scale, such as a reconstruction: lens and sensor are scaled with the focus distance, so that blur is that of
/// the default camera focused at a distance of 0.75.
pub(crate) fn shot_camera_in_any_unit(camera: &SceneCamera) -> Camera {
    const REFERENCE_DISTANCE: f64 = 0.75;
    let lens = Camera::default();
    let scale = camera.focus_distance / REFERENCE_DISTANCE;
    let (aperture_radius, sensor_height) = (scale * lens.aperture_radius, scale * lens.sensor_height);
    shot_camera_from(camera, &Camera { aperture_radius, sensor_height, ..lens })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat4;
    use scene::CameraLens;

    #[test]
    fn blur_does_not_depend_on_the_unit_of_the_scene() {
        let shot_in_unit = |unit: f64| {
            let camera = SceneCamera {
                name: "framing".into(),
                index: None,
                camera_to_world: DMat4::IDENTITY,
                yfov: 0.7,
                aspect: None,
                focus_distance: 0.75 * unit,
                lens: CameraLens::default(),
            };
            shot_camera_in_any_unit(&camera)
        };
        let (metres, others) = (shot_in_unit(1.0), shot_in_unit(130.0));
        assert_eq!(metres.aperture_radius, Camera::default().aperture_radius);
        assert!((others.f_number() / metres.f_number() - 1.0).abs() < 1e-12);
        assert!((others.aperture_radius / metres.aperture_radius / 130.0 - 1.0).abs() < 1e-12);
    }
}
