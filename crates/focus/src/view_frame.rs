//! A view that is painted in: from a position in it to a ray, and back.

use glam::{DMat4, DVec2, DVec3};
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
}

impl ViewFrame {
    /// Where the view looks from.
    pub fn eye(&self) -> DVec3 {
        self.camera_to_world.w_axis.truncate()
    }

    /// Where the view looks from, and the world direction of a position in it ((0, 0) upper left, (1, 1) lower
    /// right), of depth 1 along the view's axis.
    pub fn ray(&self, position: DVec2) -> (DVec3, DVec3) {
        let half_height = (self.yfov / 2.0).tan();
        let x = (2.0 * position.x - 1.0) * self.aspect * half_height;
        let y = (1.0 - 2.0 * position.y) * half_height;
        let m = &self.camera_to_world;
        let direction = m.x_axis.truncate() * x + m.y_axis.truncate() * y - m.z_axis.truncate();
        (self.eye(), direction)
    }

    /// Where in the view a world point appears; `None` behind the eye. Inverse of [`Self::ray`].
    pub fn position(&self, point: DVec3) -> Option<DVec2> {
        let m = &self.camera_to_world;
        let away = point - self.eye();
        let depth = -m.z_axis.truncate().dot(away);
        let half_height = (self.yfov / 2.0).tan() * depth;
        let x = m.x_axis.truncate().dot(away) / (half_height * self.aspect);
        let y = m.y_axis.truncate().dot(away) / half_height;
        (depth > 0.0).then(|| DVec2::new(1.0 + x, 1.0 - y) / 2.0)
    }

    /// Whether it can be looked through.
    pub fn is_valid(&self) -> bool {
        let angle = self.yfov > 0.0 && self.yfov < std::f64::consts::PI;
        angle && self.aspect > 0.0 && self.aspect.is_finite() && self.camera_to_world.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn a_point_on_a_ray_appears_where_the_ray_goes_through() {
        let pose = DMat4::from_rotation_translation(DQuat::from_rotation_y(0.7), DVec3::new(1.0, 2.0, 3.0));
        let view = ViewFrame { camera_to_world: pose, yfov: 0.8, aspect: 1.6 };
        for at in [DVec2::ZERO, DVec2::new(0.3, 0.9), DVec2::new(1.4, -0.2)] {
            let (eye, direction) = view.ray(at);
            let found = view.position(eye + direction * 5.0).unwrap();
            assert!(found.distance(at) < 1e-12, "{found} {at}");
            assert_eq!(view.position(eye - direction), None, "behind the eye");
        }
    }
}
