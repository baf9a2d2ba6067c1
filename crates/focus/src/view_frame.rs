//! A view that is painted in: from a position in it to a ray, and back.

use glam::{DMat4, DVec2, DVec3};
use lens::Camera;
use serde::{Deserialize, Serialize};

/// A perspective view that was painted in.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViewFrame {
    /// Its pose, glTF axes: looks down −Z, +Y up. A rotation and a translation.
    pub camera_to_world: DMat4,
    /// Full vertical angle of view, rad.
    pub yfov: f64,
    /// Width over height.
    pub aspect: f64,
    /// Offset of its frame from its axis, in frame heights, right and up ([`lens::Camera::shift`]).
    #[serde(default, skip_serializing_if = "is_zero")]
    pub shift: DVec2,
}

fn is_zero(shift: &DVec2) -> bool {
    *shift == DVec2::ZERO
}

impl ViewFrame {
    /// The frame of a camera's view: pose, angle of view, aspect and shift.
    pub fn from_camera(camera: &Camera) -> Self {
        let &Camera { camera_to_world, yfov, shift, .. } = camera;
        Self { camera_to_world, yfov, aspect: camera.aspect(), shift }
    }

    /// World position of the eye.
    pub fn eye(&self) -> DVec3 {
        self.camera_to_world.w_axis.truncate()
    }

    /// The eye, and the world direction of a position in the view ((0, 0) upper left, (1, 1) lower right), with depth
    /// 1 along the view's axis.
    pub fn ray(&self, position: DVec2) -> (DVec3, DVec3) {
        let half_height = (self.yfov / 2.0).tan();
        let x = ((2.0 * position.x - 1.0) * self.aspect + 2.0 * self.shift.x) * half_height;
        let y = (1.0 - 2.0 * position.y + 2.0 * self.shift.y) * half_height;
        let m = &self.camera_to_world;
        let direction = m.x_axis.truncate() * x + m.y_axis.truncate() * y - m.z_axis.truncate();
        (self.eye(), direction)
    }

    /// Position in the view of a world point; `None` behind the eye. Inverse of [`Self::ray`].
    pub fn position(&self, point: DVec3) -> Option<DVec2> {
        let m = &self.camera_to_world;
        let away = point - self.eye();
        let depth = -m.z_axis.truncate().dot(away);
        let half_height = (self.yfov / 2.0).tan() * depth;
        let x = (m.x_axis.truncate().dot(away) / half_height - 2.0 * self.shift.x) / self.aspect;
        let y = m.y_axis.truncate().dot(away) / half_height - 2.0 * self.shift.y;
        (depth > 0.0).then(|| DVec2::new(1.0 + x, 1.0 - y) / 2.0)
    }

    /// Whether it is a valid perspective view.
    pub fn is_valid(&self) -> bool {
        let angle = self.yfov > 0.0 && self.yfov < std::f64::consts::PI;
        angle
            && self.aspect > 0.0
            && self.aspect.is_finite()
            && self.camera_to_world.is_finite()
            && self.shift.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn a_point_on_a_ray_appears_at_the_rays_position() {
        let pose = DMat4::from_rotation_translation(DQuat::from_rotation_y(0.7), DVec3::new(1.0, 2.0, 3.0));
        let shift = DVec2::new(0.4, -0.3);
        let camera = Camera {
            width: 1600,
            height: 1000,
            yfov: 0.8,
            shift,
            camera_to_world: pose,
            ..Camera::default()
        };
        let view = ViewFrame::from_camera(&camera);
        for at in [DVec2::ZERO, DVec2::new(0.3, 0.9), DVec2::new(1.4, -0.2)] {
            let (eye, direction) = view.ray(at);
            let found = view.position(eye + direction * 5.0).unwrap();
            assert!(found.distance(at) < 1e-12, "{found} {at}");
            assert_eq!(view.position(eye - direction), None, "behind the eye");
            let seen = camera.camera_from_world(eye + direction * 5.0);
            let pixel = camera.pixel_from_q(camera.optics().chief(seen));
            assert!(pixel.distance(at * DVec2::new(1600.0, 1000.0)) < 1e-9, "{pixel} {at}");
        }
    }
}
