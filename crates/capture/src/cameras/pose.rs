//! Conversion of other programs' poses to that of a view: a rigid motion from glTF's camera axes (x right, y up,
//! looks down −z) to the world.

use glam::{DMat3, DMat4, DQuat, DVec3};

/// Computer vision's camera axes (x right, y down, z forward: COLMAP, VisualSFM, Metashape) are glTF's rotated by
/// 180° about x.
fn cv_to_gltf(rotation: DMat3) -> DMat3 {
    DMat3::from_cols(rotation.x_axis, -rotation.y_axis, -rotation.z_axis)
}

/// The pose of x_camera = R·x_world + t, in computer vision's axes; the quaternion (w, x, y, z) of R may have any length but 0.
pub(crate) fn from_world_to_camera(quaternion: [f64; 4], translation: [f64; 3]) -> Option<DMat4> {
    let rotation = rotation(quaternion)?;
    let position = -(rotation * DVec3::from(translation));
    Some(DMat4::from_mat3_translation(cv_to_gltf(rotation), position))
}

/// The pose of a camera at `center` whose R turns the world into its axes, computer vision's.
pub(crate) fn from_center(quaternion: [f64; 4], center: [f64; 3]) -> Option<DMat4> {
    Some(DMat4::from_mat3_translation(cv_to_gltf(rotation(quaternion)?), DVec3::from(center)))
}

/// From the camera to the world, for an R given by a quaternion.
fn rotation([w, x, y, z]: [f64; 4]) -> Option<DMat3> {
    let quaternion = DQuat::from_xyzw(x, y, z, w);
    let length = quaternion.length();
    // A length far from 1 is no rounding error: these four numbers are no rotation.
    ((0.5..2.0).contains(&length)).then(|| DMat3::from_quat((quaternion / length).inverse()))
}

/// The pose of a matrix from the camera to the world, of glTF's axes or computer vision's, which may have a scale.
pub(crate) fn from_camera_to_world(matrix: DMat4, axes: Axes) -> Option<DMat4> {
    let scaled = DMat3::from_mat4(matrix);
    let scale = scaled.determinant().cbrt();
    if !(matrix.is_finite() && scale > 0.0) {
        return None;
    }
    let near = scaled * scale.recip();
    let deviation = near.transpose() * near - DMat3::IDENTITY;
    if deviation.to_cols_array().iter().any(|entry| entry.abs() > 1e-2) {
        return None;
    }
    // Removes rounding errors.
    let rotation = DMat3::from_quat(DQuat::from_mat3(&near).normalize());
    let rotation = if axes == Axes::Vision { cv_to_gltf(rotation) } else { rotation };
    Some(DMat4::from_mat3_translation(rotation, matrix.w_axis.truncate()))
}

/// The directions of a camera's axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axes {
    /// x right, y up, looks down −z: glTF, OpenGL, Blender, Bundler.
    Gltf,
    /// x right, y down, looks along z.
    Vision,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colmap_camera_that_looks_along_x() {
        // It is at (1, 2, 3) and looks along +x, the world's +y up: rows of R are its right, down, forward.
        let rotation = DMat3::from_cols(DVec3::Z, DVec3::NEG_Y, DVec3::X).transpose();
        let q = DQuat::from_mat3(&rotation);
        let t = -(rotation * DVec3::new(1.0, 2.0, 3.0));
        let pose = from_world_to_camera([q.w, q.x, q.y, q.z], t.to_array()).unwrap();
        let expected = DMat4::from_mat3_translation(
            DMat3::from_cols(DVec3::Z, DVec3::Y, DVec3::NEG_X),
            DVec3::new(1.0, 2.0, 3.0),
        );
        assert!(pose.abs_diff_eq(expected, 1e-12), "{pose}");
        let by_center = from_center([q.w, q.x, q.y, q.z], [1.0, 2.0, 3.0]).unwrap();
        assert!(by_center.abs_diff_eq(expected, 1e-12));
        let vision = DMat4::from_mat3_translation(rotation.transpose() * 7.0, DVec3::new(1.0, 2.0, 3.0));
        assert!(from_camera_to_world(vision, Axes::Vision).unwrap().abs_diff_eq(expected, 1e-12));
        assert!(from_camera_to_world(expected, Axes::Gltf).unwrap().abs_diff_eq(expected, 1e-12));
    }

    #[test]
    fn what_is_no_pose_is_none() {
        assert_eq!(from_world_to_camera([0.0; 4], [0.0; 3]), None);
        assert_eq!(from_world_to_camera([9.0, 0.0, 0.0, 0.0], [0.0; 3]), None);
        assert_eq!(from_camera_to_world(DMat4::ZERO, Axes::Gltf), None);
        assert_eq!(from_camera_to_world(DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0)), Axes::Gltf), None);
        assert_eq!(from_camera_to_world(DMat4::from_scale(DVec3::new(1.0, 1.0, 2.0)), Axes::Gltf), None);
    }
}
