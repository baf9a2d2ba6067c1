//! What of the shot camera adjustment layers depend on.

use glam::{DMat4, DVec2};
use lens::Camera;

/// Pose, angle of view, sensor height and where its frame lies: where things stand before the camera, and what a blur means as an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdjustmentView {
    camera_to_world: DMat4,
    yfov: f64,
    sensor_height: f64,
    shift: DVec2,
}

impl AdjustmentView {
    /// That of a camera.
    pub fn from_camera(camera: &Camera) -> Self {
        let &Camera { camera_to_world, yfov, sensor_height, shift, .. } = camera;
        Self { camera_to_world, yfov, sensor_height, shift }
    }
}
