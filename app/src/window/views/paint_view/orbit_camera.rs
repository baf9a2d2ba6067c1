//! The camera of the paint view: orbits around a pivot, pans and zooms. Not part of the document.

use crate::window::tools::navigation::Motion;
use focus::ViewFrame;
use glam::{DMat4, DQuat, DVec2, DVec3, DVec4};
use lens::Camera;
use serde::{Deserialize, Serialize};

/// Orbit angle per point of pointer movement, rad.
const ORBIT_RAD_PER_POINT: f64 = 0.008;
/// Factor of the distance for one wheel step.
const ZOOM_PER_STEP: f64 = 0.88;
/// Scroll distance of one wheel step, points.
pub const POINTS_PER_STEP: f64 = 40.0;
/// Smallest angle between the line of sight and the vertical, rad: keeps the horizon level.
const POLE_MARGIN_RAD: f64 = 0.02;

/// A turntable camera aimed at a pivot. World space; it looks along its own −Z, with +Y up.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrbitCamera {
    /// The point it orbits around.
    pub pivot: DVec3,
    /// Distance of the eye from the pivot, > 0.
    pub distance: f64,
    /// Rotation from view to world.
    pub orientation: DQuat,
    /// Full vertical angle of view, rad.
    pub yfov: f64,
}

impl Default for OrbitCamera {
    fn default() -> Self {
        Self { pivot: DVec3::ZERO, distance: 5.0, orientation: DQuat::IDENTITY, yfov: 0.7 }
    }
}

impl OrbitCamera {
    /// The view of the shot camera, with the pivot at `pivot_distance` along its axis.
    pub fn from_shot(camera: &Camera, pivot_distance: f64) -> Self {
        let orientation = DQuat::from_mat4(&camera.camera_to_world).normalize();
        let forward = orientation * DVec3::NEG_Z;
        Self {
            pivot: camera.position() + forward * pivot_distance,
            distance: pivot_distance,
            orientation,
            yfov: camera.yfov,
        }
    }

    /// Whether its values are valid: a stored camera may hold anything.
    pub fn is_usable(&self) -> bool {
        let lengths = self.distance > 0.0 && self.distance.is_finite() && self.pivot.is_finite();
        lengths && self.orientation.is_normalized() && self.yfov > 0.0 && self.yfov < std::f64::consts::PI
    }

    /// Position of the eye.
    pub fn eye(&self) -> DVec3 {
        self.pivot + self.orientation * DVec3::Z * self.distance
    }

    /// Orbits around the pivot: about the vertical for x, about its own horizontal axis for y. In points, y
    /// down.
    pub fn orbit(&mut self, delta: DVec2) {
        let yaw = DQuat::from_rotation_y(-delta.x * ORBIT_RAD_PER_POINT);
        let turned = yaw * self.orientation;
        let forward = turned * DVec3::NEG_Z;
        let elevation = forward.y.clamp(-1.0, 1.0).asin();
        let limit = std::f64::consts::FRAC_PI_2 - POLE_MARGIN_RAD;
        let target_elevation = (elevation - delta.y * ORBIT_RAD_PER_POINT).clamp(-limit, limit);
        // A view that is already beyond the limit (a shot camera looking straight down) may only move away
        // from it.
        let pitch = if elevation.abs() > limit && target_elevation.abs() >= limit {
            0.0
        } else {
            target_elevation - elevation
        };
        self.orientation = (turned * DQuat::from_rotation_x(pitch)).normalize();
    }

    /// Pans so that the plane through the pivot follows the pointer. In points, y down.
    pub fn pan(&mut self, delta: DVec2, view_height: f64) {
        let per_point = 2.0 * self.distance * (self.yfov / 2.0).tan() / view_height.max(1.0);
        self.pivot += self.orientation * DVec3::new(-delta.x * per_point, delta.y * per_point, 0.0);
    }

    /// Zooms in by `steps` wheel steps (negative: out).
    pub fn zoom(&mut self, steps: f64) {
        self.distance = (self.distance * ZOOM_PER_STEP.powf(steps)).clamp(1e-6, 1e9);
    }

    /// Moves by a drag, in points (y down), in a view of this height.
    pub fn drag(&mut self, motion: Motion, delta: DVec2, view_height: f64) {
        match motion {
            Motion::Orbit => self.orbit(delta),
            Motion::Slide => self.pan(delta, view_height),
            Motion::Nearer => self.zoom(-delta.y / POINTS_PER_STEP * 2.0),
        }
    }

    /// Frames a box from the current direction.
    pub fn frame(&mut self, (low, high): (DVec3, DVec3), aspect: f64) {
        if !(low.is_finite() && high.is_finite()) {
            return;
        }
        let radius = ((high - low).length() / 2.0).max(1e-6);
        let half_height = (self.yfov / 2.0).tan();
        let half_angle = half_height.min(half_height * aspect).atan();
        self.pivot = (low + high) / 2.0;
        self.distance = radius / half_angle.sin();
    }

    /// Makes `point` the pivot, keeping the orientation and the eye's distance from it.
    pub fn center_on(&mut self, point: DVec3) {
        let distance = self.eye().distance(point);
        self.pivot = point;
        self.distance = distance.max(1e-6);
    }

    /// The view position (x right, y up, [−1, 1] inside the view) of a world point in front of the eye.
    pub fn project(&self, point: DVec3, aspect: f64) -> Option<DVec2> {
        let view = self.orientation.inverse() * (point - self.eye());
        let depth = -view.z;
        let half_height = (self.yfov / 2.0).tan();
        (depth > 0.0).then(|| DVec2::new(view.x / aspect, view.y) / (half_height * depth))
    }

    /// Pixels per unit length across the view at a point, in a view of `height` px; infinite beside the eye.
    pub fn pixels_per_unit(&self, point: DVec3, height: f64) -> f64 {
        let depth = (point - self.eye()).dot(self.orientation * DVec3::NEG_Z);
        height / (2.0 * (self.yfov / 2.0).tan() * depth.max(0.0))
    }

    /// Matrix to clip space from world space translated by −`origin`: reversed depth without a far plane.
    ///
    /// `extent` is the scene's size; the near plane keeps 1e-4 of it or of the distance, whichever is less.
    pub fn clip_from_world(&self, origin: DVec3, extent: f64, aspect: f64) -> DMat4 {
        let near = 1e-4 * extent.max(1e-6).min(self.distance);
        let world_from_view = DMat4::from_rotation_translation(self.orientation, self.eye() - origin);
        let scale = 1.0 / (self.yfov / 2.0).tan();
        let clip_from_view = DMat4::from_cols(
            DVec4::new(scale / aspect, 0.0, 0.0, 0.0),
            DVec4::new(0.0, scale, 0.0, 0.0),
            DVec4::new(0.0, 0.0, 0.0, -1.0),
            DVec4::new(0.0, 0.0, near, 0.0),
        );
        clip_from_view * world_from_view.inverse()
    }

    /// Its view frame at this aspect ratio (width over height).
    pub fn view(&self, aspect: f64) -> ViewFrame {
        ViewFrame { camera_to_world: self.pose(), yfov: self.yfov, aspect, shift: DVec2::ZERO }
    }

    /// Its pose: camera to world.
    pub fn pose(&self) -> DMat4 {
        DMat4::from_rotation_translation(self.orientation, self.eye())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> OrbitCamera {
        let orientation = DQuat::from_euler(glam::EulerRot::YXZ, 0.6, -0.3, 0.0);
        OrbitCamera { pivot: DVec3::new(1.0, 2.0, -3.0), distance: 4.0, orientation, yfov: 0.8 }
    }

    #[test]
    fn ray_and_projection_invert() {
        let camera = camera();
        let frame = camera.view(1.5);
        // (0.65, 0.85) of the way from the upper left corner is (0.3, −0.7) from the middle.
        let (origin, direction) = frame.ray(DVec2::new(0.65, 0.85));
        let projected = camera.project(origin + direction * 7.0, 1.5).unwrap();
        assert!(projected.distance(DVec2::new(0.3, -0.7)) < 1e-12, "{projected}");
        assert_eq!(camera.project(origin - direction, 1.5), None, "behind the eye");
    }

    #[test]
    fn matrix_agrees_with_the_projection() {
        let camera = camera();
        let origin = DVec3::new(10.0, 0.0, 0.0);
        let point = DVec3::new(0.5, 1.7, -2.0);
        let clip = camera.clip_from_world(origin, 10.0, 1.5).project_point3(point - origin);
        assert!(clip.truncate().distance(camera.project(point, 1.5).unwrap()) < 1e-9);
        assert!(clip.z > 0.0 && clip.z < 1.0, "reverse depth inside the view: {}", clip.z);
    }

    #[test]
    fn orbit_keeps_pivot_distance_and_horizon() {
        let mut camera = camera();
        for step in 0..500 {
            camera.orbit(DVec2::new(13.0, if step < 250 { 40.0 } else { -90.0 }));
            assert!((camera.eye().distance(camera.pivot) - 4.0).abs() < 1e-9);
            assert!((camera.orientation * DVec3::X).y.abs() < 1e-9, "the horizon stays level");
            assert!((camera.orientation * DVec3::Y).y > 0.0, "never upside down");
        }
    }

    #[test]
    fn pan_moves_the_pivot_with_the_pointer() {
        let mut camera = camera();
        let old = camera.pivot;
        camera.pan(DVec2::new(50.0, 20.0), 400.0);
        let projected = camera.project(old, 1.0).unwrap();
        assert!(projected.distance(DVec2::new(50.0 / 200.0, -20.0 / 200.0)) < 1e-9, "{projected}");
    }

    #[test]
    fn framing_shows_all_corners() {
        let mut camera = camera();
        let (low, high) = (DVec3::new(-5.0, 0.0, -1.0), DVec3::new(3.0, 2.0, 9.0));
        for aspect in [0.5, 2.0] {
            camera.frame((low, high), aspect);
            for i in 0..8 {
                let pick = |bit: u32, a: f64, b: f64| if i >> bit & 1 == 0 { a } else { b };
                let corner =
                    DVec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z));
                let projected = camera.project(corner, aspect).unwrap();
                assert!(projected.abs().max_element() <= 1.0 + 1e-9, "{corner} at {projected}");
            }
        }
        let before = camera;
        camera.frame((DVec3::INFINITY, DVec3::NEG_INFINITY), 1.0);
        assert_eq!(camera, before, "an empty box moves nothing");
    }

    #[test]
    fn looking_from_the_shot_camera_sees_its_axis() {
        let pose = DMat4::from_rotation_translation(DQuat::from_rotation_y(1.0), DVec3::new(1.0, 1.0, 1.0));
        let shot = Camera { camera_to_world: pose, ..Camera::default() };
        let view = OrbitCamera::from_shot(&shot, 3.0);
        assert!(view.eye().distance(shot.position()) < 1e-12);
        let ahead = shot.world_from_camera(DVec3::new(0.0, 0.0, 5.0));
        assert!(view.project(ahead, 1.0).unwrap().length() < 1e-12);
    }
}
