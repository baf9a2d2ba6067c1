//! Watertightness of closed meshes, and occlusion between close shells.

use crate::case::{Case, Effort, NOT_COMPUTED, Verdict};
use crate::support::measure::worst;
use crate::support::shot::Shot;
use glam::DVec3;
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::{Scene, SurfacePoint};
use std::sync::atomic::{AtomicU64, Ordering};
use test_scenes::{Mesh, Random, unlit_scene_of};
use trace::{Ray, Tracer};

pub const CASES: &[Case] = &[
    Case {
        name: "watertight closed meshes",
        reason: "A ray from inside a closed mesh hits it, also through edges and vertices, near the origin \
                 and far from it.",
        control: "Möller and Trumbore's test in f32, triangle by triangle",
        check: closed_meshes,
    },
    Case {
        name: "shells 4e-5 apart at distance 1",
        reason: "The nearer shell occludes the farther one from every point of the aperture.",
        control: "occlusion rays that start 1e-4 off the surface",
        check: close_shells,
    },
];

/// Rays per parallel task.
const CHUNK: u32 = 20_000;

fn closed_meshes(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let places = [DVec3::ZERO, DVec3::new(1e4, -1e4, 1e4)];
    let total = effort.choose(10_000_000, 200_000);
    let (mut leaks, mut naive_leaks) = (0, 0);
    for center in places {
        let scene = unlit_scene_of([(&Mesh::sphere(center, 1.0, 24), [1.0; 3])]);
        let tracer = Tracer::new(scene.clone());
        let chunks = total / CHUNK / places.len() as u32;
        let of_chunk = |chunk: u32| -> Result<u64, Cancelled> {
            progress.check()?;
            let rays = aimed_rays(&scene, center, Random(u64::from(chunk)), CHUNK);
            Ok(rays.filter(|ray| tracer.first_hit(ray).is_none()).count() as u64)
        };
        let lost = AtomicU64::new(0);
        (0..chunks).into_par_iter().try_for_each(|chunk| {
            lost.fetch_add(of_chunk(chunk)?, Ordering::Relaxed);
            Ok(())
        })?;
        leaks += lost.into_inner();
        let few = aimed_rays(&scene, center, Random(0), CHUNK / 4);
        naive_leaks += few.filter(|ray| !is_hit_in_f32(&scene, ray)).count();
    }
    let expected = format!("no leak among {total} rays at edges and vertices");
    Ok(Verdict::new(expected, [("leaks", 0.0)], [leaks as f64], [naive_leaks as f64]))
}

/// Rays from inside a sphere around `center` to random points on its edges and vertices.
fn aimed_rays(scene: &Scene, center: DVec3, mut random: Random, count: u32) -> impl Iterator<Item = Ray> {
    (0..count).map(move |_| {
        let triangle = (random.unit() * scene.triangles.len() as f64) as u32;
        let aim = SurfacePoint { triangle, barycentric: random.on_outline() }.position(scene);
        let origin = center + 0.5 * random.in_cube();
        Ray { origin, direction: aim - origin, t_min: 0.0, t_max: f64::INFINITY, skip: None }
    })
}

/// Möller and Trumbore 1997, in f32.
fn is_hit_in_f32(scene: &Scene, ray: &Ray) -> bool {
    let (origin, direction) = (ray.origin.as_vec3(), ray.direction.as_vec3());
    (0..scene.triangles.len() as u32).any(|triangle| {
        let [a, b, c] = scene.corners(triangle).map(|p| p.as_vec3());
        let (e1, e2) = (b - a, c - a);
        let p = direction.cross(e2);
        let determinant = e1.dot(p);
        let s = origin - a;
        let q = s.cross(e1);
        let (u, v) = (s.dot(p) / determinant, direction.dot(q) / determinant);
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && e2.dot(q) / determinant > 0.0
    })
}

fn close_shells(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    // In pictures: a white shell in front of a red one, with the camera at distance 1.
    let (width, height) = effort.choose((48, 36), (24, 18));
    let camera =
        Camera { width, height, yfov: 0.7, aperture_radius: 0.1, focus_distance: 2.0, ..Camera::default() };
    let center = DVec3::new(0.0, 0.0, -2.0);
    let [near, far] = [1.0, 1.0 - 4e-5].map(|radius| Mesh::sphere(center, radius, 48));
    let scene = unlit_scene_of([(&far, [1.0, 0.0, 0.0]), (&near, [0.0, 1.0, 0.0])]);
    let shot = Shot::new(scene.clone(), camera);
    let red = |picture: Picture| worst(picture.radiance.iter().map(|rgb| f64::from(rgb[0])));
    let offset = FocusOffset::new(0.99, 1.0);
    let pictures = [shot.splat(offset, progress)?, shot.truth(offset, 64, progress)?];
    let in_pictures = worst(pictures.map(red));

    let mut random = Random(5);
    let (mut visible_count, mut visible_with_offset) = (0, 0);
    for _ in 0..effort.choose(200_000, 20_000) {
        let triangle = (random.unit() * far.triangles.len() as f64) as u32;
        let point = SurfacePoint { triangle, barycentric: random.in_triangle() };
        let eye = center + random.direction() * 2.0;
        visible_count += u32::from(!shot.tracer.is_occluded(point, eye));
        let origin = point.position(&scene);
        let direction = (eye - origin).normalize();
        let ray = Ray { origin, direction, t_min: 1e-4, t_max: f64::INFINITY, skip: None };
        visible_with_offset += u32::from(!shot.tracer.any_hit(&ray));
    }
    let expected = "nothing of the farther shell in any picture; every point of it occluded from every \
                    direction outside";
    let limits = [("seen", 0.0), ("radiance", 0.0)];
    Ok(Verdict::new(
        expected,
        limits,
        [f64::from(visible_count), in_pictures],
        [f64::from(visible_with_offset), NOT_COMPUTED],
    ))
}
