//! Views: photographs of a scene, with the cameras that took them.
//!
//! Pixels are not stored: [`View::read_photograph`] and [`View::read_mask`] read them on demand.

use glam::{DMat4, DVec2, DVec3};
use lens::CalibratedLens;
use std::path::PathBuf;

/// A photograph and its camera.
///
/// Spaces are those of [`lens::Camera`]: the world's axes are the scene's; the camera's own are glTF's in
/// `camera_to_world` (x right, y up, looks along −z), and x right, y up, z *forward* in camera space, in which
/// [`CalibratedLens`] has its directions. Readers convert once: computer vision's axes (COLMAP: x right, y down, z
/// forward) are glTF's rotated by 180° about x.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Its name: its path below the folder of the pictures, with `/`; unique within a capture.
    pub name: String,
    /// The picture's file.
    pub picture: PathBuf,
    /// How the file's pixels become the picture that the lens refers to: an EXIF orientation (1 to 8; 1: unchanged).
    ///
    /// Not the file's own, see [`Self::exif_orientation`]: reconstruction programs differ in whether they rotate
    /// pictures first, so what counts is which orientation makes width and height those of the lens.
    pub orientation: u8,
    /// The orientation in the picture's EXIF data, 1 to 8; 1 if there is none.
    pub exif_orientation: u8,
    /// The lens; its size is the picture's, orientation applied.
    pub lens: CalibratedLens,
    /// Pose, a rigid motion: the world from glTF's camera axes.
    pub camera_to_world: DMat4,
    /// A picture that marks the valid pixels of the photograph, if there is one.
    pub mask: Option<PathBuf>,
    /// log₂(t·S/N²) of exposure time t in s, ISO speed S and f-number N, if EXIF gives them: how much brighter, in
    /// stops, the camera rendered the same radiance. Only differences between views are meaningful, and they are a
    /// hint.
    pub exposure_hint: Option<f64>,
}

impl View {
    /// From the world to glTF's camera axes: the inverse of [`Self::camera_to_world`].
    pub fn world_to_camera(&self) -> DMat4 {
        let rotation = glam::DMat3::from_mat4(self.camera_to_world).transpose();
        DMat4::from_mat3_translation(rotation, rotation * -self.position())
    }

    /// The camera's position in the world.
    pub fn position(&self) -> DVec3 {
        self.camera_to_world.w_axis.truncate()
    }

    /// Viewing direction: unit direction of the camera's axis in the world.
    pub fn forward(&self) -> DVec3 {
        -self.camera_to_world.z_axis.truncate()
    }

    /// The camera's up direction (world, unit).
    pub fn up(&self) -> DVec3 {
        self.camera_to_world.y_axis.truncate()
    }

    /// A world point in camera space (x right, y up, z forward, the camera at the origin).
    pub fn camera_from_world(&self, point: DVec3) -> DVec3 {
        let pose = &self.camera_to_world;
        let offset = point - self.position();
        let along = |axis: glam::DVec4| axis.truncate().dot(offset);
        DVec3::new(along(pose.x_axis), along(pose.y_axis), -along(pose.z_axis))
    }

    /// The pixel position (x right, y down, (0.5, 0.5) the centre of the upper left pixel) of a world point, inside
    /// or outside the picture; `None` if the lens cannot see it.
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        self.lens.project(self.camera_from_world(point))
    }

    /// The unit direction in the world, from [`Self::position`], of a pixel position; `None` if the lens sees nothing
    /// there.
    pub fn direction(&self, pixel: DVec2) -> Option<DVec3> {
        let DVec3 { x, y, z } = self.lens.unproject(pixel)?;
        Some(self.camera_to_world.transform_vector3(DVec3::new(x, y, -z)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One that stands at (1, 2, 3), looks along +x and is upright.
    fn view() -> View {
        let [right, up, back] = [DVec3::Z, DVec3::Y, DVec3::NEG_X];
        View {
            name: "a.jpg".into(),
            picture: "a.jpg".into(),
            orientation: 1,
            exif_orientation: 1,
            lens: CalibratedLens::pinhole([640, 480], 500.0).unwrap(),
            camera_to_world: DMat4::from_mat3_translation(
                glam::DMat3::from_cols(right, up, back),
                DVec3::new(1.0, 2.0, 3.0),
            ),
            mask: None,
            exposure_hint: None,
        }
    }

    #[test]
    fn what_lies_ahead_above_to_the_right() {
        let view = view();
        let point = DVec3::new(3.0, 2.1, 3.2);
        assert_eq!(view.forward(), DVec3::X);
        assert!(view.camera_from_world(point).abs_diff_eq(DVec3::new(0.2, 0.1, 2.0), 1e-12));
        assert!(view.project(point).unwrap().abs_diff_eq(DVec2::new(370.0, 215.0), 1e-9));
        assert_eq!(view.project(DVec3::new(0.0, 2.0, 3.0)), None);
    }

    #[test]
    fn directions_lead_back_to_the_point() {
        let view = view();
        let point = DVec3::new(3.0, 2.1, 3.2);
        let direction = view.direction(view.project(point).unwrap()).unwrap();
        assert!(direction.abs_diff_eq((point - view.position()).normalize(), 1e-12));
        let there_and_back = view.world_to_camera() * view.camera_to_world;
        assert!(there_and_back.abs_diff_eq(DMat4::IDENTITY, 1e-12));
    }
}
