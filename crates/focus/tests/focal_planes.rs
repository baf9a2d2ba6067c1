//! Focal planes: tilted and curved, against rays that are cut with them; and what no lens sees.

use focus::{Adjustment, Canvas, CanvasTexel, FocalPlane, FocusLayer, FocusMap};
use glam::{DMat4, DQuat, DVec3, EulerRot, Vec3};
use lens::{Camera, FocusOffset};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// A texel at each of these places.
fn canvas(places: &[DVec3]) -> Arc<Canvas> {
    let texel = |(x, &position): (usize, &DVec3)| CanvasTexel {
        x: x as u32,
        y: 0,
        position,
        normal: Vec3::Y,
        area: 1e-4,
        part: 0,
        chart: 0,
    };
    let texels = places.iter().enumerate().map(texel).collect();
    Arc::new(Canvas::from_texels([places.len() as u32, 1], texels, &[], vec![[0, 0]]))
}

fn camera() -> Camera {
    let turn = DQuat::from_euler(EulerRot::YXZ, 0.4, -0.2, 0.1);
    let pose = DMat4::from_rotation_translation(turn, DVec3::new(0.3, 1.2, -0.5));
    Camera { camera_to_world: pose, focus_distance: 3.0, ..Camera::default() }
}

/// A place before the camera, in its own axes.
fn before(camera: &Camera, x: f64, y: f64, depth: f64) -> DVec3 {
    camera.world_from_camera(DVec3::new(x * depth, y * depth, depth))
}

fn map_of(plane: &FocalPlane, places: &[DVec3], camera: &Camera) -> FocusMap {
    let layer = FocusLayer::from_adjustment("p", Adjustment::Plane(plane.clone()), &canvas(places), camera);
    assert!(layer.is_valid());
    layer.map
}

#[test]
fn a_tilted_plane_blurs_as_a_lens_focused_where_the_ray_meets_it() {
    let camera = camera();
    let optics = camera.optics();
    let plane = FocalPlane::through([
        before(&camera, -0.3, -0.2, 1.5),
        before(&camera, 0.3, -0.1, 2.0),
        before(&camera, 0.1, 0.3, 6.0),
    ])
    .unwrap();
    let [a, b, c] = plane.points.map(|point| camera.camera_from_world(point));
    let normal = (b - a).cross(c - a);
    let places: Vec<_> = (0..200)
        .map(|k| {
            let k = k as f64;
            before(&camera, 0.35 * (k * 0.7).sin(), 0.3 * (k * 1.3).cos(), 0.4 + 0.05 * k)
        })
        .collect();
    let map = map_of(&plane, &places, &camera);
    // Positions are 32-bit floats from the middle of the surface: half a unit in the last place of its extent.
    let extent = places.iter().map(|place| place.distance(places[0])).fold(0.0, f64::max);
    for (x, place) in places.iter().enumerate() {
        let seen = camera.camera_from_world(*place);
        let share = normal.dot(a) / normal.dot(seen);
        let wanted = 1.0 / (share * seen.z) - 1.0 / seen.z;
        let found = optics.kappa(1.0 / seen.z, map.at(x as u32, 0));
        // Values are 32-bit floats of t ≈ 1: half a unit in the last place, over d.
        let rounding = 6e-8 * (1.0 + wanted.abs() * optics.image_distance) / optics.image_distance;
        let rounding = rounding + 6e-8 * extent / seen.z.powi(2);
        assert!((found - wanted).abs() <= rounding + 1e-12, "{place}: {found}, not {wanted}");
    }
    // What lies in it is sharp, wherever the lens focuses.
    let within: Vec<_> = (0..50)
        .map(|k| {
            let [u, v] = [(k % 7) as f64 / 3.0 - 1.0, (k / 7) as f64 / 3.0 - 1.0];
            plane.points[0]
                + (plane.points[1] - plane.points[0]) * u
                + (plane.points[2] - plane.points[0]) * v
        })
        .filter(|place| camera.camera_from_world(*place).z > 0.0)
        .collect();
    let other = Camera { focus_distance: 0.7, ..camera.clone() };
    for camera in [&camera, &other] {
        let map = map_of(&plane, &within, camera);
        assert!((0..within.len()).all(|x| (map.at(x as u32, 0).t - 1.0).abs() < 1e-6));
    }
}

#[test]
fn a_plane_across_the_axis_is_the_ordinary_lens_and_its_curvature_the_corners() {
    let camera = camera();
    let optics = camera.optics();
    let plane = FocalPlane::facing(&camera, camera.focus_distance);
    assert!((plane.depth_on_axis(&camera) - 3.0).abs() < 1e-12);
    assert!(plane.tilt_and_swing(&camera).iter().all(|angle| angle.abs() < 1e-12));
    let tan = optics.tan_half_yfov;
    let places = [0.0, 0.5, 1.0].map(|y| before(&camera, 0.0, y * tan, 2.0));
    for curvature in [0.0, 1e-9, 0.2, -0.2] {
        let map = map_of(&FocalPlane { curvature, ..plane.clone() }, &places, &camera);
        for (x, y) in [0.0f64, 0.5, 1.0].into_iter().enumerate() {
            let wanted = optics.standard_kappa(1.0 / 2.0) + curvature * y * y;
            let found = optics.kappa(1.0 / 2.0, map.at(x as u32, 0));
            assert!((found - wanted).abs() < 6e-8 / optics.image_distance, "{found}, not {wanted}");
        }
        let far = map.background;
        assert!((optics.kappa(0.0, far) - optics.standard_kappa(0.0)).abs() < 1e-9, "{far:?}");
    }
}

#[test]
fn turned_and_moved_planes_are_where_they_were_put() {
    let camera = camera();
    let plane = FocalPlane::facing(&camera, 2.0);
    for turn in [[0.6, 0.0], [0.0, -0.9], [1.2, 0.7], [-1.5, 1.5]] {
        let turned = plane.with_tilt_and_swing(&camera, turn);
        let found = turned.tilt_and_swing(&camera);
        assert!((found[0] - turn[0]).abs() < 1e-9 && (found[1] - turn[1]).abs() < 1e-9, "{found:?}");
        assert!(turned.is_valid());
        let moved = turned.with_depth_on_axis(&camera, 4.0);
        assert!((moved.depth_on_axis(&camera) - 4.0).abs() < 1e-9);
        assert!((moved.tilt_and_swing(&camera)[0] - turn[0]).abs() < 1e-9);
    }
    // A right angle is as steep as can be.
    assert!(plane.with_tilt_and_swing(&camera, [FRAC_PI_2, 0.0]).tilt_and_swing(&camera)[0] < FRAC_PI_2);
    // Above 0, the upper part is nearer: what is there and behind it is far blurred.
    let tilted = plane.with_tilt_and_swing(&camera, [0.5, 0.0]);
    let map = map_of(&tilted, &[before(&camera, 0.0, 0.2, 2.0), before(&camera, 0.0, -0.2, 2.0)], &camera);
    assert!(map.at(0, 0).t > 1.0 && map.at(1, 0).t < 1.0);
}

#[test]
fn hard_cases_are_finite_and_points_in_a_line_no_plane() {
    let camera = camera();
    let line = [1.0, 2.0, 3.0].map(|depth| before(&camera, 0.1, 0.1, depth));
    assert_eq!(FocalPlane::through(line), None);
    assert_eq!(FocalPlane::through([DVec3::ZERO; 3]), None);
    assert_eq!(FocalPlane::through([DVec3::NAN, DVec3::X, DVec3::Y]), None);
    // In the plane, beside it, nearly in it; along the axis; behind.
    let eye = camera.position();
    let forward = camera.world_direction(DVec3::Z);
    let up = camera.world_direction(DVec3::Y);
    let places = [
        eye,
        eye + forward * 1e-300,
        eye + forward * 1e-9 + up * 1e-9,
        eye - forward,
        eye + forward * 2.0,
        eye + forward * 2.0 + up,
        eye + forward * 1e12,
    ];
    let through_eye = FocalPlane::through([eye, eye + forward, eye + up]).unwrap();
    let beside = FocalPlane::through([eye + up, eye + up + forward, eye + up + forward.cross(up)]).unwrap();
    let behind = FocalPlane::facing(&camera, -1.0);
    for plane in [through_eye, beside, behind] {
        for curvature in [0.0, 3.0, -1e6] {
            let plane = FocalPlane { curvature, ..plane.clone() };
            let map = map_of(&plane, &places, &camera);
            assert!(map.background.is_valid());
            for x in 0..places.len() as u32 {
                let focus = map.at(x, 0);
                assert!(focus.is_valid(), "{plane:?}: {focus:?}");
            }
            assert_eq!(map.at(3, 0), FocusOffset::STANDARD, "behind the camera");
        }
    }
}
