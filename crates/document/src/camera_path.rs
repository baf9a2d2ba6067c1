//! The path from one camera to another, around the place that both look at.
//!
//! Photographs are usually taken from around a place. A straight line between two of their cameras would come nearer to it, so the path is
//! an arc about the point p nearest to both optical axes: directions from p and distances to it are interpolated.
//!
//! ```text
//! c(s) = p + |r(s)|·slerp(r₀/|r₀|, r₁/|r₁|; s)        rᵢ = cᵢ − p        |r(s)| = (1 − s)|r₀| + s|r₁|
//! ```
//!
//! If the axes are parallel or meet behind a camera, the path is the straight line, which is the limit of the arc as p moves to infinity.

use glam::{DMat3, DMat4, DQuat, DVec3};
use lens::Camera;

/// sin² of the angle between axes below which they count as parallel: the arc is then within 10⁻⁴ of its chord of the straight line.
const PARALLEL_SINE_SQUARED: f64 = 1e-7;

/// The camera at a `share` of the path in [0, 1]; 0 is exactly `from`, 1 exactly the pose, framing and focus of `to`. The tangent of the
/// angle of view is interpolated geometrically, the inverse of the focus distance linearly; size and lens are those of `from`.
pub fn camera_between(from: &Camera, to: &Camera, share: f64) -> Camera {
    if share <= 0.0 {
        return from.clone();
    }
    if share >= 1.0 {
        return Camera {
            yfov: to.yfov,
            focus_distance: to.focus_distance,
            shift: to.shift,
            camera_to_world: to.camera_to_world,
            ..from.clone()
        };
    }
    let mix = |a: f64, b: f64| a + (b - a) * share;
    let tangent = |camera: &Camera| (0.5 * camera.yfov).tan();
    let [q, r] = [from, to].map(|camera| DQuat::from_mat3(&DMat3::from_mat4(camera.camera_to_world)));
    let position = position_between(from, to, share);
    Camera {
        yfov: 2.0 * (tangent(from).powf(1.0 - share) * tangent(to).powf(share)).atan(),
        focus_distance: 1.0 / mix(1.0 / from.focus_distance, 1.0 / to.focus_distance),
        shift: from.shift.lerp(to.shift, share),
        camera_to_world: DMat4::from_rotation_translation(q.slerp(r, share), position),
        ..from.clone()
    }
}

fn position_between(from: &Camera, to: &Camera, share: f64) -> DVec3 {
    let [a, b] = [from, to].map(|camera| camera.camera_to_world.w_axis.truncate());
    let [f, g] = [from, to].map(|camera| -camera.camera_to_world.z_axis.truncate().normalize());
    let straight = a.lerp(b, share);
    let Some(pivot) = nearest_point_to_axes([a, b], [f, g]) else { return straight };
    let (r, s) = (a - pivot, b - pivot);
    if r == DVec3::ZERO || s == DVec3::ZERO {
        return straight;
    }
    let rotation = DQuat::from_rotation_arc(r.normalize(), s.normalize());
    let distance = r.length() + (s.length() - r.length()) * share;
    pivot + DQuat::IDENTITY.slerp(rotation, share) * r.normalize() * distance
}

/// The point nearest to two axes, if it lies in front of both cameras.
fn nearest_point_to_axes([a, b]: [DVec3; 2], [f, g]: [DVec3; 2]) -> Option<DVec3> {
    let cosine = f.dot(g);
    let sine_squared = f.cross(g).length_squared();
    if sine_squared < PARALLEL_SINE_SQUARED {
        return None;
    }
    let (u, v) = ((b - a).dot(f), (b - a).dot(g));
    let [along_f, along_g] = [(u - cosine * v) / sine_squared, (cosine * u - v) / sine_squared];
    (along_f > 0.0 && along_g > 0.0).then(|| 0.5 * (a + f * along_f + b + g * along_g))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(position: DVec3, at: DVec3) -> DMat4 {
        let back = (position - at).normalize();
        let right = DVec3::Y.cross(back).normalize();
        DMat4::from_cols(
            right.extend(0.0),
            back.cross(right).extend(0.0),
            back.extend(0.0),
            position.extend(1.0),
        )
    }

    fn looking(position: DVec3, at: DVec3) -> Camera {
        Camera { camera_to_world: pose(position, at), ..Camera::default() }
    }

    fn position(camera: &Camera) -> DVec3 {
        camera.camera_to_world.w_axis.truncate()
    }

    #[test]
    fn around_a_ring_the_distance_is_constant_and_the_centre_stays_in_view() {
        let at = DVec3::new(1.0, 0.5, -2.0);
        let around = |angle: f64| looking(at + 3.0 * DVec3::new(angle.cos(), 0.0, angle.sin()), at);
        let (a, b) = (around(0.3), around(1.5));
        for share in [0.1, 0.5, 0.9] {
            let camera = camera_between(&a, &b, share);
            assert!((position(&camera).distance(at) - 3.0).abs() < 1e-9, "{share}");
            let camera_space = camera.camera_to_world.inverse().transform_point3(at);
            assert!(camera_space.truncate().length() < 1e-9 && camera_space.z < 0.0, "{camera_space}");
            let straight = position(&a).lerp(position(&b), share);
            assert!(straight.distance(at) < 2.9, "a straight line would come nearer");
        }
    }

    #[test]
    fn the_ends_are_the_cameras_themselves() {
        let (a, b) = (looking(DVec3::X, DVec3::ZERO), looking(DVec3::Z * 2.0, DVec3::Y));
        assert_eq!(camera_between(&a, &b, 0.0), a);
        assert_eq!(camera_between(&a, &b, 1.0).camera_to_world, b.camera_to_world);
    }

    #[test]
    fn parallel_axes_give_a_line_and_nearly_parallel_axes_nearly_a_line() {
        let a = looking(DVec3::ZERO, -DVec3::Z);
        for turned in [0.0, 1e-9, 3.2e-4, 1e-3, 1e-2] {
            let b = looking(DVec3::X, DVec3::new(1.0 - turned, 0.0, -1.0));
            let off = position(&camera_between(&a, &b, 0.5)).distance(DVec3::X * 0.5);
            assert!(off < 0.2 * turned + 1e-9, "{turned}: {off}");
        }
        // Looking apart, and at one place from opposite sides.
        let apart = looking(DVec3::X, DVec3::new(2.0, 0.0, -1.0));
        assert_eq!(position(&camera_between(&a, &apart, 0.5)), DVec3::X * 0.5);
        let opposite = camera_between(&looking(-DVec3::X, DVec3::ZERO), &looking(DVec3::X, DVec3::ZERO), 0.5);
        assert!(opposite.camera_to_world.is_finite());
    }

    #[test]
    fn focus_at_infinity_is_no_trouble() {
        let mut a = looking(DVec3::X, DVec3::ZERO);
        let b = looking(DVec3::Z, DVec3::ZERO);
        a.focus_distance = f64::INFINITY;
        let camera = camera_between(&a, &b, 0.5);
        assert!((camera.focus_distance - 2.0 * b.focus_distance).abs() < 1e-9);
    }
}
