//! The shot: the camera, and points of the world given by their position in its picture.

use glam::{Mat4, Quat, Vec3};
use serde_json::{Value, json};

/// The camera of the demo. Lengths in metres, angles in rad.
pub struct View {
    /// Aperture centre.
    pub eye: Vec3,
    /// Upward tilt.
    pub pitch: f32,
    /// Full vertical angle of view.
    pub yfov: f32,
    /// Focus distance.
    pub focus_distance: f32,
    /// Aperture radius.
    pub aperture_radius: f32,
}

impl Default for View {
    /// A 47 mm lens at about f/1.1, close up and low.
    fn default() -> Self {
        Self {
            eye: Vec3::new(0.0, 0.205, 0.0),
            pitch: -0.045,
            yfov: 0.5,
            focus_distance: 0.72,
            aperture_radius: 0.0205,
        }
    }
}

impl View {
    fn rotation(&self) -> Quat {
        Quat::from_rotation_x(self.pitch)
    }

    /// World from camera, glTF axes.
    pub fn matrix(&self) -> Mat4 {
        Mat4::from_rotation_translation(self.rotation(), self.eye)
    }

    /// The world point at this depth that appears at (x, y) half picture heights from the picture's centre.
    pub fn at(&self, x: f32, y: f32, depth: f32) -> Vec3 {
        let tan = (self.yfov / 2.0).tan();
        self.eye + self.rotation() * (Vec3::new(x * tan, y * tan, -1.0) * depth)
    }

    /// The point of the ground (y = 0) below [`Self::at`].
    pub fn ground(&self, x: f32, depth: f32) -> Vec3 {
        self.at(x, 0.0, depth).with_y(0.0)
    }

    /// Forced perspective, as on a stage: moves a point along its line of sight so that what lies beyond a
    /// metre is squeezed into 3.3 m. From the eye nothing changes; but the far things shrink, and no longer
    /// take the atlas's texels from the near ones.
    ///
    /// 1/depth becomes F + (1 − F)/depth with F = 0.3, a projective map: straight lines stay straight.
    pub fn staged(&self, point: Vec3) -> Vec3 {
        const FLATTENING: f32 = 0.3;
        let depth = (self.rotation() * Vec3::NEG_Z).dot(point - self.eye);
        if depth <= 1.0 {
            return point;
        }
        self.eye + (point - self.eye) / (FLATTENING * depth + 1.0 - FLATTENING)
    }

    /// The camera file.
    pub fn file(&self) -> Value {
        let rows = self.matrix().transpose().to_cols_array_2d();
        json!({"width": 960, "height": 540, "yfov": self.yfov, "focus_distance": self.focus_distance,
            "aperture_radius": self.aperture_radius, "sensor_height": 0.024,
            "camera_to_world": rows, "background": [0.02, 0.04, 0.1],
            "aperture": {"shape": "disc"}})
    }
}
