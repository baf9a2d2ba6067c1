//! The first view of a scene that has no camera: what is to be seen fills the frame, from inside if it is a room, and what lies in front of
//! and behind the point of focus is visibly blurred.

use crate::focus_hold::HeldCamera;
use crate::picking::chief_ray;
use glam::{DMat3, DMat4, DVec2, DVec3};
use lens::Camera;
use numerics::quantile;
use project::FocusHold;
use trace::{Ray, Tracer};

/// The diameter of the largest circle of confusion, picture heights.
const LARGEST_CIRCLE: f64 = 0.03;
/// The lens is at most this wide, as a share of the focus distance: in a flat scene nothing is blurred anyway.
const WIDEST_RADIUS: f64 = 0.1;
/// Columns and rows of the grid of rays that measure depth.
const DEPTH_GRID: [u32; 2] = [48, 32];
/// Focus is sought in the middle, of these shares of width and height.
const MIDDLE: DVec2 = DVec2::new(0.4, 0.5);
/// Depths are measured without this share of outliers at either end.
const OUTLIERS: f64 = 0.03;

/// Smallest width and height of a room, in glTF's unit, the metre.
const SMALLEST_ROOM: DVec3 = DVec3::new(1.5, 1.2, 1.5);
/// Where a person's eye is, above the floor.
const EYE_HEIGHT: f64 = 1.6;
/// From inside a room at least this share of all directions meets the front of a surface.
const ENCLOSURE: f64 = 0.75;
/// The angle of view in a room, rad.
const ROOM_YFOV: f64 = 0.9;
/// How far the camera steps back towards the wall behind it.
const STEP_BACK: f64 = 0.75;

/// The camera of the first view, from one that frames the scene from outside.
pub(crate) fn first_view(tracer: &Tracer, framing: &Camera) -> HeldCamera {
    let posed = match room_pose(tracer, framing) {
        Some(camera_to_world) => Camera { camera_to_world, yfov: ROOM_YFOV, ..framing.clone() },
        None => framing.clone(),
    };
    focused(tracer, posed)
}

/// Focuses on what is nearest in the middle, with an aperture that blurs the rest visibly.
fn focused(tracer: &Tracer, camera: Camera) -> HeldCamera {
    let [columns, rows] = DEPTH_GRID;
    let positions = (0..rows).flat_map(|row| {
        (0..columns).map(move |column| {
            let cell = DVec2::new(f64::from(column), f64::from(row)) + 0.5;
            cell / DVec2::new(f64::from(columns), f64::from(rows))
        })
    });
    let seen: Vec<(DVec2, DVec3)> = positions
        .filter_map(|at| {
            let ray = chief_ray(&camera, at);
            tracer.visible_surface(&ray).map(|hit| (at, ray.origin + ray.direction * hit.t))
        })
        .collect();
    let depth = |position: DVec3| camera.camera_from_world(position).z;
    let is_middle = |at: DVec2| ((at - 0.5).abs() / (MIDDLE / 2.0)).max_element() <= 1.0;
    let mut all: Vec<f64> = seen.iter().map(|(_, position)| depth(*position)).collect();
    let middle = seen.iter().filter(|(at, _)| is_middle(*at));
    let mut middle: Vec<f64> = middle.map(|(_, position)| depth(*position)).collect();
    let nearest = quantile(&mut middle, OUTLIERS).or(quantile(&mut all, OUTLIERS));
    let subject = seen.iter().find(|(_, position)| Some(depth(*position)) == nearest);
    let (Some(nearest), Some(&(_, subject))) = (nearest, subject) else {
        return HeldCamera::on_axis(camera);
    };
    let focused = Camera { focus_distance: nearest, ..camera };
    let optics = focused.optics();
    let circle = |depth: f64| {
        let kappa = optics.standard_kappa(1.0 / depth);
        2.0 * optics.splat_radius_px(kappa).abs() / f64::from(focused.height)
    };
    let ends = [OUTLIERS, 1.0 - OUTLIERS].map(|share| quantile(&mut all, share).map_or(0.0, circle));
    let widest = WIDEST_RADIUS * focused.focus_distance / focused.aperture_radius;
    // The sensor grows with the aperture, so that the f-number stays that of a lens.
    let scale = (LARGEST_CIRCLE / ends[0].max(ends[1])).min(widest);
    let camera = Camera {
        aperture_radius: focused.aperture_radius * scale,
        sensor_height: focused.sensor_height * scale,
        ..focused
    };
    HeldCamera { camera, focus_hold: FocusHold::Point(subject) }
}

/// A pose in a room, from one end of its longest line of sight towards the other; `None` if the scene is not one. Up is +y.
fn room_pose(tracer: &Tracer, framing: &Camera) -> Option<DMat4> {
    let is_upright = framing.camera_to_world.x_axis.y.abs() < 1e-6 && framing.camera_to_world.y_axis.y > 0.0;
    let (low, high) = tracer.scene().bounds();
    let size = high - low;
    if tracer.has_splats() || !is_upright || !size.cmpge(SMALLEST_ROOM).all() {
        return None;
    }
    let height = low.y + EYE_HEIGHT.min(size.y / 2.0);
    let shares = [0.25, 0.5, 0.75];
    let eyes = shares
        .into_iter()
        .flat_map(|x| shares.map(|z| DVec3::new(low.x + x * size.x, height, low.z + z * size.z)));
    let enclosed = eyes.filter_map(|eye| enclosure(tracer, eye).map(|clearance| (eye, clearance)));
    let (eye, _) = enclosed.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let headings = (0..32).map(|k| {
        let (sin, cos) = (f64::from(k) / 32.0 * std::f64::consts::TAU).sin_cos();
        DVec3::new(sin, 0.0, cos)
    });
    let longest = |(a, _): &(f64, DVec3), (b, _): &(f64, DVec3)| a.total_cmp(b);
    let sight = |heading: DVec3| distance(tracer, eye, heading).unwrap_or(0.0);
    let (_, ahead) = headings.map(|heading| (sight(heading), heading)).max_by(longest)?;
    let position = eye - ahead * (STEP_BACK * sight(-ahead));
    let right = ahead.cross(DVec3::Y);
    Some(DMat4::from_mat3_translation(DMat3::from_cols(right, DVec3::Y, -ahead), position))
}

/// The mean distance to what surrounds a point on all sides; `None` if it is not inside of anything.
fn enclosure(tracer: &Tracer, eye: DVec3) -> Option<f64> {
    const DIRECTIONS: u32 = 128;
    let directions = (0..DIRECTIONS).map(|k| {
        // A Fibonacci lattice on the sphere.
        let y = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(DIRECTIONS);
        let (sin, cos) = (f64::from(k) * std::f64::consts::PI * (3.0 - 5f64.sqrt())).sin_cos();
        let radius = (1.0 - y * y).sqrt();
        DVec3::new(radius * cos, y, radius * sin)
    });
    let scene = tracer.scene();
    let distances: Vec<f64> = directions
        .filter_map(|direction| {
            let hit = tracer.first_hit(&ray(eye, direction))?;
            (scene.area_normal(hit.point.triangle).dot(direction) < 0.0).then_some(hit.t)
        })
        .collect();
    let is_enclosed = distances.len() as f64 >= ENCLOSURE * f64::from(DIRECTIONS);
    is_enclosed.then(|| distances.iter().sum::<f64>() / distances.len() as f64)
}

/// How far one sees in a direction; `None`: out of the scene.
fn distance(tracer: &Tracer, eye: DVec3, direction: DVec3) -> Option<f64> {
    tracer.first_hit(&ray(eye, direction)).map(|hit| hit.t)
}

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction, t_min: 0.0, t_max: f64::INFINITY, skip: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Material;
    use test_scenes::{Mesh, scene_of};

    /// A view from the front, at this distance.
    fn framing(distance: f64) -> Camera {
        let camera_to_world = DMat4::from_translation(DVec3::Z * distance);
        Camera { camera_to_world, focus_distance: distance, ..Camera::default() }
    }

    fn tracer(meshes: impl IntoIterator<Item = Mesh>) -> Tracer {
        let material = || Material { double_sided: false, ..Material::lambertian_white() };
        Tracer::new(scene_of(meshes.into_iter().map(|mesh| (mesh, material()))))
    }

    fn cube(center: DVec3, half: f64) -> Mesh {
        Mesh::cuboid(center - half, center + half)
    }

    fn largest_circle(camera: &Camera, depths: [f64; 2]) -> f64 {
        let optics = camera.optics();
        let circle = |z: f64| 2.0 * optics.splat_radius_px(optics.standard_kappa(1.0 / z)).abs();
        depths.map(circle).into_iter().fold(0.0, f64::max) / f64::from(camera.height)
    }

    #[test]
    fn the_nearest_thing_in_the_middle_is_sharp_and_the_farthest_blurred() {
        for unit in [1e-3, 1.0, 1e4] {
            let things = [cube(DVec3::ZERO, 0.3 * unit), cube(DVec3::new(1.5, 0.0, -4.0) * unit, 0.5 * unit)];
            let HeldCamera { camera, focus_hold } = first_view(&tracer(things), &framing(3.0 * unit));
            camera.validate().unwrap();
            assert!((camera.focus_distance / unit - 2.7).abs() < 1e-6, "{}", camera.focus_distance);
            assert!(matches!(focus_hold, FocusHold::Point(at) if (at.z / unit - 0.3).abs() < 1e-6));
            let circle = largest_circle(&camera, [2.7 * unit, 6.5 * unit]);
            assert!((circle - LARGEST_CIRCLE).abs() < 0.1 * LARGEST_CIRCLE, "{circle}");
            assert!((camera.f_number() / Camera::default().f_number() - 1.0).abs() < 0.05);
        }
    }

    #[test]
    fn a_wall_alone_gets_no_absurd_lens_and_nothing_none() {
        let wall = cube(DVec3::NEG_Z * 50.0, 50.0);
        let HeldCamera { camera, .. } = first_view(&tracer([wall]), &framing(3.0));
        camera.validate().unwrap();
        assert!(camera.aperture_radius <= WIDEST_RADIUS * camera.focus_distance * (1.0 + 1e-9));
        let aside = framing(3.0);
        let beside = cube(DVec3::X * 100.0, 0.1);
        assert_eq!(first_view(&tracer([beside]), &aside).camera, aside, "nothing is in view");
    }

    #[test]
    fn rooms_are_seen_from_inside_and_objects_from_outside() {
        let outside = framing(9.0);
        // A box turned inside out: 6 × 3 × 10 m.
        let mut room = Mesh::cuboid(DVec3::new(-3.0, 0.0, -5.0), DVec3::new(3.0, 3.0, 5.0));
        room.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        let table = cube(DVec3::new(0.5, 0.4, 0.0), 0.4);
        let camera = first_view(&tracer([room, table.clone()]), &outside).camera;
        let eye = camera.camera_to_world.w_axis.truncate();
        assert!(eye.abs().cmplt(DVec3::new(3.0, 3.0, 5.0)).all() && eye.z.abs() > 2.5, "at one end: {eye}");
        assert!(camera.camera_to_world.z_axis.z.abs() > 0.8, "it looks along the room");
        camera.validate().unwrap();
        let block = Mesh::cuboid(DVec3::new(-3.0, 0.0, -5.0), DVec3::new(3.0, 3.0, 5.0));
        let camera = first_view(&tracer([block]), &outside).camera;
        assert_eq!(camera.camera_to_world, outside.camera_to_world);
        assert_eq!(first_view(&tracer([table]), &outside).camera.camera_to_world, outside.camera_to_world);
    }
}
