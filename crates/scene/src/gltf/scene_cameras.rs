//! The file's cameras, and a default camera for a scene without one.

use crate::error::Fault;
use crate::gltf::document::{Document, nonempty_name};
use crate::gltf::focus_brush_extras;
use crate::{CameraLens, Scene, SceneCamera};
use gaussians::CloudRay;
use glam::{DMat3, DMat4, DQuat, DVec3};
use gltf::camera::Projection;
use gltf::json::camera::Type;
use gltf::json::validation::Checked;
use std::f64::consts::PI;

/// The camera of a node with the transform `world`, if it is a usable perspective camera.
pub(crate) fn node_camera(
    document: &Document<'_>,
    node: &gltf::Node<'_>,
    world: DMat4,
) -> Result<Option<SceneCamera>, Fault> {
    document.check_at(&format!("/nodes/{}/camera", node.index()))?;
    let Some(camera) = node.camera() else { return Ok(None) };
    let index = camera.index();
    let place = format!("/cameras/{index}");
    let skip = |why: &str| {
        document.warn(format!("{place}: {why}; the camera is left out"));
        Ok(None)
    };
    if let Err(fault) = document.check_at(&format!("{place}/type")) {
        document.warn(format!("{fault}; the camera is left out"));
        return Ok(None);
    }
    document.check_below(&place)?;
    // The typed view relies on the type to agree with the property of that name.
    let json = document.typed().as_json().cameras.get(index);
    match json.map(|camera| (&camera.type_, &camera.perspective)) {
        Some((Checked::Valid(Type::Perspective), Some(_))) => {}
        Some((Checked::Valid(Type::Perspective), None)) => {
            return Err(Fault::Malformed {
                place: format!("{place}/perspective"),
                what: "is missing".into(),
            });
        }
        _ => return skip("is orthographic, and only perspective cameras have a lens"),
    }
    let Projection::Perspective(perspective) = camera.projection() else { return Ok(None) };
    let yfov = f64::from(perspective.yfov());
    if !(yfov > 0.0 && yfov < PI) {
        return skip("its yfov is not between 0 and π");
    }
    let aspect = perspective.aspect_ratio().map(f64::from).filter(|&aspect| aspect > 0.0);
    let Some(camera_to_world) = rigid_transform(world) else { return skip("its transform is singular") };
    let name = nonempty_name(camera.name())
        .or(nonempty_name(node.name()))
        .unwrap_or_else(|| format!("camera {index}"));
    let lens = focus_brush_extras::camera_lens(document, index, yfov);
    let index = Some(index as u32);
    Ok(Some(SceneCamera { name, index, camera_to_world, yfov, aspect, focus_distance: 1.0, lens }))
}

/// The pose of a transform: the viewing direction (−Z) is preserved, up as far as possible; scale and mirroring are
/// removed.
fn rigid_transform(world: DMat4) -> Option<DMat4> {
    let position = world.w_axis.truncate();
    let back = world.z_axis.truncate().try_normalize()?;
    let up = world.y_axis.truncate();
    let up = (up - back * back.dot(up)).try_normalize()?;
    let axes = DMat3::from_cols(up.cross(back), up, back);
    position.is_finite().then(|| DMat4::from_mat3_translation(axes, position))
}

/// A camera that sees the whole scene in a picture at least as wide as high, from the front, right and above, and as
/// close as possible. `upright` rotates the world so that up is +y and the front +z.
pub(crate) fn framing_camera(scene: &Scene, upright: DQuat) -> SceneCamera {
    const YFOV: f64 = 0.7;
    /// Margin around the scene.
    const MARGIN: f64 = 1.1;
    let back = DVec3::new(0.6, 0.45, 1.0).normalize();
    let right = DVec3::Y.cross(back).normalize();
    let [right, up, back] = [right, back.cross(right), back].map(|axis| upright.inverse() * axis);
    let slope = (0.5 * YFOV).tan() / MARGIN;
    // From (p, d) along an axis across and along `back` a point (x, z) is in view if |x − p| ≤ slope·(d − z): so p +
    // slope·d is at least every x + slope·z, and p − slope·d at most every x − slope·z.
    let ends = scene.extent().fold([[f64::INFINITY, f64::NEG_INFINITY]; 2], |ends, position| {
        let z = slope * position.dot(back);
        [(ends[0], right), (ends[1], up)].map(|([low, high], axis)| {
            let x = position.dot(axis);
            [low.min(x - z), high.max(x + z)]
        })
    });
    let [across, along] = ends.map(|[low, high]| 0.5 * (low + high));
    let distance =
        ends.iter().map(|[low, high]| (high - low) / (2.0 * slope)).fold(f64::NEG_INFINITY, f64::max);
    let (low, high) = scene.bounds();
    // All in one point: any distance will do.
    let nearest = (high - low).length() * 1e-3;
    let surface = front_extent(scene, back);
    let distance = distance.max(surface + if nearest > 0.0 { nearest } else { 1.0 });
    let position = right * across + up * along + back * distance;
    SceneCamera {
        name: "framing".into(),
        index: None,
        camera_to_world: DMat4::from_mat3_translation(DMat3::from_cols(right, up, back), position),
        yfov: YFOV,
        aspect: None,
        focus_distance: (position - 0.5 * (low + high)).dot(back),
        lens: CameraLens::default(),
    }
}

/// The maximum extent of the scene in a direction.
fn front_extent(scene: &Scene, direction: DVec3) -> f64 {
    scene.extent().map(|position| position.dot(direction)).fold(f64::NEG_INFINITY, f64::max)
}

/// Sets the focus distances: to the first surface on the axis, else to the middle of the scene.
pub(crate) fn focus_cameras(scene: &mut Scene) {
    /// Maximum number of ray-triangle tests: some tenths of a second. Further cameras focus on the middle.
    const MAX_TESTS: usize = 50_000_000;
    let (low, high) = scene.bounds();
    let centre = 0.5 * (low + high);
    let affordable = MAX_TESTS / scene.triangles.len().max(1);
    let distance = |camera: &SceneCamera, should_trace: bool| {
        let (origin, axis) =
            (camera.camera_to_world.w_axis.truncate(), -camera.camera_to_world.z_axis.truncate());
        let ahead = should_trace.then(|| first_hit_distance(scene, origin, axis)).flatten();
        ahead.unwrap_or_else(|| {
            let middle = (centre - origin).dot(axis);
            // The scene lies behind the camera: use its distance.
            if middle > 0.0 { middle } else { (centre - origin).length().max(f64::MIN_POSITIVE) }
        })
    };
    let distances: Vec<f64> =
        scene.cameras.iter().enumerate().map(|(i, camera)| distance(camera, i < affordable)).collect();
    for (camera, distance) in scene.cameras.iter_mut().zip(distances) {
        camera.focus_distance = distance;
    }
}

/// The distance to the nearest triangle along a ray (Möller and Trumbore 1997), or to the surface of splats.
fn first_hit_distance(scene: &Scene, origin: DVec3, direction: DVec3) -> Option<f64> {
    let hit = |triangle: u32| {
        let [a, b, c] = scene.corners(triangle);
        let (e1, e2) = (b - a, c - a);
        let p = direction.cross(e2);
        let det = e1.dot(p);
        let s = origin - a;
        let q = s.cross(e1);
        let (u, v, t) = (s.dot(p) / det, direction.dot(q) / det, e2.dot(q) / det);
        // A ray in the triangle's plane gives NaN or infinity, which fails.
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t.is_finite()).then_some(t)
    };
    let splats = scene.splats.iter().filter_map(|splats| {
        let ray = CloudRay::new(&splats.placement, origin, direction);
        ray.surface_of_all(&splats.cloud).map(|hit| hit.depth)
    });
    scene.surface_triangles().filter_map(hit).chain(splats).min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_loses_scale_and_mirroring() {
        let world = DMat4::from_translation(DVec3::ONE)
            * DMat4::from_rotation_y(0.5)
            * DMat4::from_scale(DVec3::new(-2.0, 3.0, 4.0));
        let pose = rigid_transform(world).unwrap();
        let expected = DMat4::from_translation(DVec3::ONE) * DMat4::from_rotation_y(0.5);
        assert!(pose.abs_diff_eq(expected, 1e-12), "{pose}");
        assert_eq!(rigid_transform(DMat4::ZERO), None);
    }
}
