//! Estimation of the up direction of a world.

use glam::{DMat3, DQuat, DVec3};
use scene::View;

/// The weight of the cameras' up directions relative to that of their horizontal axes.
const SHARE_OF_UP: f64 = 0.01;

/// The rotation that makes +y the up direction of a world. People hold cameras level, however they tilt them to look up or down: up is the
/// direction u to which the cameras' right axes are most nearly perpendicular. If those are all parallel, the cameras' up directions
/// decide: the minimum of u·A·u of
///
/// ```text
/// A = Σ right·rightᵀ + 0.01·Σ (1 − up·upᵀ)
/// ```
///
/// by inverse iteration from the mean up direction. The identity if that is 0.
pub(crate) fn estimate_upright(views: &[View]) -> DQuat {
    let outer = |axis: DVec3| DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
    let of_view = |view: &View| {
        let right = view.camera_to_world.x_axis.truncate();
        outer(right) + (DMat3::IDENTITY - outer(view.up())) * SHARE_OF_UP
    };
    let matrix = views.iter().map(of_view).fold(DMat3::ZERO, |sum, matrix| sum + matrix);
    let mean: DVec3 = views.iter().map(View::up).sum();
    let Some(mut up) = mean.try_normalize() else { return DQuat::IDENTITY };
    // A small regularisation for cameras that agree exactly; it changes no direction.
    let inverse = (matrix + DMat3::IDENTITY * (1e-9 * views.len() as f64)).inverse();
    // The second eigenvalue is well above the least, or the difference does not matter.
    for _ in 0..50 {
        up = (inverse * up).normalize_or(up);
    }
    DQuat::from_rotation_arc(if up.dot(mean) < 0.0 { -up } else { up }, DVec3::Y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat4;
    use lens::CalibratedLens;

    /// The estimated up direction of cameras that look in these directions, level except for a roll (rad), where up
    /// is `world_up`.
    fn estimated_up(world_up: DVec3, directions: &[(DVec3, f64)]) -> DVec3 {
        let view_from = |&(forward, roll): &(DVec3, f64)| {
            let forward = forward.normalize();
            let right = DQuat::from_axis_angle(forward, roll) * forward.cross(world_up).normalize();
            View {
                name: String::new(),
                picture: "".into(),
                orientation: 1,
                exif_orientation: 1,
                lens: CalibratedLens::pinhole([3, 2], 2.0).unwrap(),
                camera_to_world: DMat4::from_mat3(DMat3::from_cols(right, right.cross(forward), -forward)),
                mask: None,
                exposure_hint: None,
            }
        };
        estimate_upright(&directions.iter().map(view_from).collect::<Vec<_>>()).inverse() * DVec3::Y
    }

    #[test]
    fn cameras_that_look_down_from_some_sides() {
        let down = |angle: f64| (DVec3::new(-angle.sin(), -0.8, -angle.cos()), 0.0);
        let up = estimated_up(DVec3::Y, &[0.0, 0.4, 0.8].map(down));
        assert!(up.y > 0.999, "{up}");
        // The mean of their up directions would be off by their tilt.
    }

    #[test]
    fn cameras_that_look_one_way() {
        let up =
            estimated_up(DVec3::Z, &[(DVec3::X, 0.05), (DVec3::X, -0.05), (DVec3::new(1.0, 0.02, 0.0), 0.0)]);
        assert!(up.z > 0.999, "{up}");
        assert!(estimated_up(DVec3::NEG_Y, &[(DVec3::Z, 0.0)]).y < -0.999);
    }

    #[test]
    fn cameras_that_agree_on_nothing() {
        let up = estimated_up(DVec3::Y, &[(DVec3::Z, 0.0), (DVec3::Z, std::f64::consts::PI)]);
        assert!(up.is_finite() && up.is_normalized(), "{up}");
    }
}
