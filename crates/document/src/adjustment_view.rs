//! The properties of the shot camera that adjustment layers depend on.

use glam::{DMat4, DVec2};
use lens::Camera;

/// The properties of the shot camera that adjustment layers depend on: pose, angle of view and shift, which decide where things are in camera
/// space, and sensor height, which relates blur to focus offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdjustmentView {
    camera_to_world: DMat4,
    yfov: f64,
    sensor_height: f64,
    shift: DVec2,
}

impl AdjustmentView {
    /// What adjustment layers depend on of `camera`.
    pub fn from_camera(camera: &Camera) -> Self {
        let &Camera { camera_to_world, yfov, sensor_height, shift, .. } = camera;
        Self { camera_to_world, yfov, sensor_height, shift }
    }
}
