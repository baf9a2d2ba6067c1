use super::*;
use crate::Beam;
use crate::{Square, TargetPoints, Viewpoint};
use glam::DVec2;
use scene::{AlphaMode, Material};
use test_scenes::{Mesh, Random, one_sided, scene_of, white};

const OFFSETS: [DVec3; 2] = [DVec3::ZERO, DVec3::new(1e5, -1e5, 1e5)];

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction, t_min: 0.0, t_max: f64::INFINITY, skip: None }
}

fn random_triangles(random: &mut Random, count: u32, size: f64) -> Mesh {
    let positions = (0..count)
        .flat_map(|_| {
            let center = random.in_cube();
            [0; 3].map(|_| center + size * random.in_cube())
        })
        .collect();
    Mesh { positions, triangles: (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect() }
}

/// First hit by testing every triangle.
fn brute_force(scene: &Scene, ray: &Ray) -> Option<Hit> {
    let sheared = ShearedRay::new(ray.origin, ray.direction);
    let crossings = (0..scene.triangles.len() as u32).filter_map(|triangle| {
        let crossing = sheared.cross(&scene.corners(triangle))?;
        let within = crossing.t > ray.t_min && crossing.t < ray.t_max && ray.skip != Some(triangle);
        let shows_back = scene.area_normal(triangle).dot(ray.direction) > 0.0;
        let within = within && !(scene.culls_back_face(triangle) && shows_back);
        let point = SurfacePoint { triangle, barycentric: crossing.barycentric };
        within.then_some(Hit { point, t: crossing.t })
    });
    crossings.min_by(|a, b| a.t.total_cmp(&b.t))
}

#[test]
fn agrees_with_testing_every_triangle() {
    let mut random = Random(1);
    for (count, size) in [(1, 1.0), (3, 0.5), (400, 0.3), (2000, 0.02)] {
        for offset in OFFSETS {
            let Mesh { mut positions, triangles } = random_triangles(&mut random, count, size);
            positions.iter_mut().for_each(|p| *p += offset);
            let material = if count % 2 == 0 { one_sided() } else { white() };
            let scene = scene_of([(Mesh { positions, triangles }, material)]);
            let tracer = Tracer::new(scene.clone());
            let mut hits = 0;
            for k in 0..3000 {
                // From within, near and far; along the axes; with short and long directions.
                let origin = offset + random.in_cube() * [0.5, 3.0, 1e3, 1e6][k % 4];
                let aim = offset + random.in_cube() * 0.7;
                let mut direction = (aim - origin) * [1e-9, 1.0, 1e9][k % 3];
                if k % 16 == 0 {
                    direction = [DVec3::X, -DVec3::Y, DVec3::Z][k / 16 % 3];
                }
                let mut ray = ray(origin, direction);
                if k % 5 == 0 {
                    ray.t_max = (aim - origin).length() / direction.length();
                }
                if k % 7 == 0 {
                    ray.skip = brute_force(&scene, &ray).map(|hit| hit.point.triangle);
                }
                let (found, expected) = (tracer.first_hit(&ray), brute_force(&scene, &ray));
                let key = |hit: Hit| (hit.point.triangle, hit.t.to_bits());
                assert_eq!(found.map(key), expected.map(key), "{ray:?}");
                assert_eq!(tracer.any_hit(&ray), expected.is_some());
                hits += usize::from(expected.is_some());
            }
            assert!(hits > 10, "{hits} hits of {count} triangles prove little");
        }
    }
}

/// Rays in a random pyramid of a beam from `origin` around `aim`, `width` wide at a depth of 1.
fn beam(random: &mut Random, origin: DVec3, aim: DVec3, width: f64, count: usize) -> (Beam, Vec<Ray>) {
    let axis = (aim - origin).normalize();
    let side = axis.any_orthonormal_vector() * width;
    let other = axis.cross(side);
    let at = |u: f64, v: f64| axis + (u - 0.5) * side + (v - 0.5) * other;
    let edges = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
    let rays = (0..count).map(|_| ray(origin, at(random.unit(), random.unit())));
    (Beam { origin, axis, edges }, rays.collect())
}

#[test]
fn the_rays_of_a_beam_meet_what_they_meet_alone() {
    let mut random = Random(11);
    let key = |hit: Hit| (hit.point.triangle, hit.t.to_bits(), hit.point.barycentric.to_array());
    let glass =
        Material { alpha: AlphaMode::Blend, base_color: glam::Vec4::new(1.0, 1.0, 1.0, 0.6), ..white() };
    for (count, size, material) in [(1, 1.0, white()), (400, 0.3, glass), (2000, 0.02, white())] {
        for offset in OFFSETS {
            let Mesh { mut positions, triangles } = random_triangles(&mut random, count, size);
            positions.iter_mut().for_each(|p| *p += offset);
            let tracer = Tracer::new(scene_of([(Mesh { positions, triangles }, material.clone())]));
            let (mut hits, mut together) = (0, 0);
            for k in 0..600 {
                let distance = [0.5, 3.0, 1e3, 1e6][k % 4];
                let (origin, aim) = (offset + random.in_cube() * distance, offset + random.in_cube() * 0.7);
                let width = [0.01, 0.3, 1e-9][k % 3] / distance;
                let (beam, mut rays) = beam(&mut random, origin, aim, width, 1 + k % Beam::MAX_RAYS);
                // Through all surfaces, one after the other.
                let most = 6;
                let mut all = tracer.all_hits(&beam, &rays, most);
                for _ in 0..most {
                    let found = tracer.first_hits(&beam, &rays);
                    for (ray, found) in rays.iter().zip(found) {
                        let alone = tracer.first_fractional_hit(ray);
                        assert_eq!(found.map(key), alone.map(key), "{beam:?} {ray:?}");
                        hits += usize::from(alone.is_some());
                    }
                    for (at, hit) in found.into_iter().enumerate().filter_map(|(at, hit)| Some((at, hit?))) {
                        let place = all.iter().position(|(of, _)| *of == at).expect("all hits have it");
                        assert_eq!(key(all.remove(place).1), key(hit), "in their order");
                    }
                    assert!(found[rays.len()..].iter().all(Option::is_none));
                    together += usize::from(found.iter().filter(|hit| hit.is_some()).count() > 1);
                    for (ray, hit) in rays.iter_mut().zip(found) {
                        let Some(hit) = hit else { continue };
                        *ray = Ray { t_min: hit.t, skip: Some(hit.point.triangle), ..*ray };
                    }
                }
                assert!(all.is_empty(), "nothing else: {all:?}");
                rays[0].t_max = 0.0;
                assert!(tracer.first_hits(&beam, &rays)[0].is_none());
            }
            assert!(hits > 50 && together > 5, "{hits} hits, {together} of beams");
        }
    }
    let tracer = Tracer::new(scene_of([(Mesh::sphere(DVec3::ZERO, 1.0, 24), white())]));
    let (around, mut rays) = beam(&mut random, DVec3::ZERO, DVec3::ONE, 3.0, 16);
    assert!(tracer.first_hits(&around, &rays).iter().all(Option::is_some), "along different axes");
    rays[3].direction = DVec3::NAN;
    assert_eq!(tracer.first_hits(&around, &rays).iter().filter(|hit| hit.is_none()).count(), 1);
    assert!(tracer.first_hits(&around, &[]).iter().all(Option::is_none));
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    let mut random = Random(2);
    for offset in OFFSETS {
        let scene = scene_of([(Mesh::sphere(offset, 1.0, 24), white())]);
        let tracer = Tracer::new(scene.clone());
        let mut leaks = 0;
        for _ in 0..500_000 {
            let triangle = (random.unit() * scene.triangles.len() as f64) as u32;
            let aim = SurfacePoint { triangle, barycentric: random.barycentric() }.position(&scene);
            let origin = offset + 0.5 * random.in_cube();
            leaks += u32::from(tracer.first_hit(&ray(origin, aim - origin)).is_none());
        }
        assert_eq!(leaks, 0, "around {offset}");
    }
}

#[test]
fn a_convex_mesh_does_not_occlude_itself() {
    let mut random = Random(3);
    for offset in OFFSETS {
        for rings in [8, 200] {
            let scene = scene_of([(Mesh::sphere(offset, 1.0, rings), white())]);
            let tracer = Tracer::new(scene.clone());
            let (mut seen, mut hidden) = (0, 0);
            while seen < 50_000 {
                let triangle = (random.unit() * scene.triangles.len() as f64) as u32;
                let point = SurfacePoint { triangle, barycentric: random.barycentric() };
                let eye = offset + 4.0 * random.in_cube();
                let origin = point.position(&scene);
                // Down to rays that graze the triangle by 1e-9 rad, which those of the far-away scene cannot
                // resolve.
                let normal = scene.area_normal(triangle).normalize();
                let smallest = if offset == DVec3::ZERO { 1e-9 } else { 1e-4 };
                let graze = random.unit().powi(8).max(smallest);
                let along = (eye - origin).reject_from(normal).normalize();
                let eye = if seen % 2 == 0 { origin + 3.0 * (along + graze * normal) } else { eye };
                if (eye - origin).dot(normal) < smallest {
                    continue;
                }
                seen += 1;
                hidden += u32::from(tracer.is_occluded(point, eye));
            }
            assert_eq!(hidden, 0, "of {seen} around {offset}, {rings} rings");
        }
    }
}

#[test]
fn the_far_side_of_a_closed_mesh_is_occluded() {
    let mut random = Random(4);
    let scene = scene_of([(Mesh::sphere(DVec3::ZERO, 1.0, 32), white())]);
    let tracer = Tracer::new(scene.clone());
    for _ in 0..20_000 {
        let triangle = (random.unit() * scene.triangles.len() as f64) as u32;
        let point = SurfacePoint { triangle, barycentric: DVec2::splat(1.0 / 3.0) };
        let eye = -2.0 * point.position(&scene) + 0.5 * random.in_cube();
        assert!(tracer.is_occluded(point, eye));
    }
}

#[test]
fn shells_occlude_each_other() {
    let mut random = Random(5);
    for offset in OFFSETS {
        let inner = Mesh::sphere(offset, 1.0, 16);
        let outer = Mesh::sphere(offset, 1.0 + 4e-5, 16);
        let shells = inner.triangles.len() as f64;
        let scene = scene_of([(inner, white()), (outer, white())]);
        let tracer = Tracer::new(scene.clone());
        for _ in 0..20_000 {
            let triangle = (random.unit() * shells) as u32;
            let point = SurfacePoint { triangle, barycentric: random.barycentric() };
            let eye = offset + random.direction() * 5.0;
            assert!(tracer.is_occluded(point, eye), "{offset}: {point:?} sees {eye}");
        }
    }
}

#[test]
fn neither_end_occludes() {
    let floor = Mesh::rectangle(DVec3::ZERO, DVec3::X, DVec3::Z);
    let wall = Mesh::rectangle(DVec3::ZERO, DVec3::Y, DVec3::Z);
    let tracer = Tracer::new(scene_of([(floor, white()), (wall, white())]));
    let on = |triangle, b1, b2| SurfacePoint { triangle, barycentric: DVec2::new(b1, b2) };
    let on_wall = on(2, 0.5, 0.25).position(tracer.scene());
    assert!(!tracer.is_occluded(on(0, 0.5, 0.25), on_wall));
    assert!(!tracer.is_occluded(on(1, 0.0, 1.0), DVec3::new(0.5, 1.0, 0.5)), "from the edge they share");
    assert!(tracer.is_occluded(on(0, 0.5, 0.25), DVec3::new(-0.5, 0.3, 0.5)), "from behind the wall");
}

#[test]
fn the_lowest_of_coincident_triangles_is_hit() {
    let quad = Mesh::rectangle(DVec3::ZERO, DVec3::X, DVec3::Y);
    let copies: Vec<_> = (0..9).map(|_| (quad.clone(), white())).collect();
    let tracer = Tracer::new(scene_of(copies));
    let mut ray = ray(DVec3::new(0.5, 0.25, 1.0), -DVec3::Z);
    assert_eq!(tracer.first_hit(&ray).unwrap().point.triangle, 0);
    ray.skip = Some(0);
    assert_eq!(tracer.first_hit(&ray).unwrap().point.triangle, 2);
}

#[test]
fn the_interval_is_open() {
    let tracer = Tracer::new(scene_of([(Mesh::rectangle(DVec3::ZERO, DVec3::X, DVec3::Y), white())]));
    let within = |t_min, t_max| {
        let ray = Ray { t_min, t_max, ..ray(DVec3::new(0.5, 0.25, 1.0), DVec3::new(0.0, 0.0, -0.25)) };
        assert_eq!(tracer.first_hit(&ray).is_some(), tracer.any_hit(&ray));
        tracer.any_hit(&ray)
    };
    assert!(within(0.0, 5.0) && within(3.999, 4.001) && within(f64::NEG_INFINITY, f64::INFINITY));
    assert!(!within(4.0, 5.0) && !within(0.0, 4.0) && !within(5.0, 3.0) && !within(f64::NAN, 5.0));
}

#[test]
fn what_is_no_ray_or_no_triangle_is_not_hit() {
    let tracer =
        Tracer::new(scene_of([(Mesh::rectangle(-DVec3::ONE, DVec3::X * 2.0, DVec3::Y * 2.0), white())]));
    for direction in [DVec3::ZERO, DVec3::splat(f64::NAN), DVec3::new(0.0, 0.0, f64::INFINITY)] {
        assert!(tracer.first_hit(&ray(-3.0 * DVec3::Z, direction)).is_none());
    }
    assert!(tracer.first_hit(&ray(DVec3::splat(f64::NAN), DVec3::Z)).is_none());
    assert!(tracer.first_hit(&ray(-3.0 * DVec3::Z, 1e-300 * DVec3::Z)).is_some());

    assert!(!Tracer::new(Arc::new(scene::Scene::default())).any_hit(&ray(DVec3::ZERO, DVec3::Z)));
    let needle = vec![DVec3::ZERO, DVec3::splat(0.1), DVec3::splat(0.3)];
    let broken = vec![DVec3::ZERO, DVec3::X, DVec3::new(0.0, f64::NAN, 0.0)];
    let endless = vec![DVec3::ZERO, DVec3::X, DVec3::new(0.0, f64::INFINITY, 0.0)];
    for positions in [needle, broken, endless] {
        let tracer = Tracer::new(scene_of([(Mesh { positions, triangles: vec![[0, 1, 2]] }, white())]));
        assert!(!tracer.any_hit(&ray(DVec3::new(0.1, 0.1, 3.0), -DVec3::new(0.0, 0.0, 1.0))));
    }
}

#[test]
fn a_deep_tree_is_walked_whole() {
    // Triangles that shrink geometrically toward a point.
    let positions = (0..3000).flat_map(|k| {
        let size = 0.98f64.powi(k);
        [DVec3::new(size, 0.0, 0.0), DVec3::new(size, 0.5 * size, 0.0), DVec3::new(size, 0.0, 0.5 * size)]
    });
    let triangles = (0..3000).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let mesh = Mesh { positions: positions.collect(), triangles };
    let scene = scene_of([(mesh, white())]);
    let tracer = Tracer::new(scene.clone());
    let mut random = Random(6);
    for _ in 0..2000 {
        let ray =
            ray(DVec3::X * 2.0, DVec3::new(-2.0, 0.5 * random.unit().powi(8), 0.5 * random.unit().powi(8)));
        let key = |hit: Hit| (hit.point.triangle, hit.t.to_bits());
        assert_eq!(tracer.first_hit(&ray).map(key), brute_force(&scene, &ray).map(key));
    }
}

fn window(alpha: AlphaMode, opacity: f32) -> Tracer {
    let material = Material { alpha, base_color: glam::Vec4::new(1.0, 1.0, 1.0, opacity), ..white() };
    let behind = Mesh::rectangle(DVec3::new(-1.0, -1.0, -2.0), DVec3::X * 2.0, DVec3::Y * 2.0);
    let pane = |z| Mesh::rectangle(DVec3::new(-1.0, -1.0, z), DVec3::X * 2.0, DVec3::Y * 2.0);
    Tracer::new(scene_of([(pane(0.0), material.clone()), (pane(-1.0), material), (behind, white())]))
}

#[test]
fn a_mask_cuts_away_what_is_below_its_cutoff() {
    let ahead = ray(DVec3::new(0.1, 0.2, 1.0), -DVec3::Z);
    for (opacity, there) in [(0.49, false), (0.5, true), (0.51, true)] {
        let tracer = window(AlphaMode::Mask(0.5), opacity);
        assert_eq!(tracer.first_hit(&ahead).unwrap().t.round(), if there { 1.0 } else { 3.0 });
    }
    assert_eq!(window(AlphaMode::Opaque, 0.0).first_hit(&ahead).unwrap().t, 1.0);
}

#[test]
fn blending_lets_its_share_of_rays_pass() {
    let tracer = window(AlphaMode::Blend, 0.3);
    let mut random = Random(7);
    let (rays, mut by_depth) = (100_000, [0.0; 4]);
    for _ in 0..rays {
        let ray = ray(DVec3::new(random.unit(), random.unit(), 1.0), -DVec3::Z);
        let t = tracer.first_hit(&ray).unwrap().t;
        assert_eq!(t, tracer.first_hit(&ray).unwrap().t, "the same ray meets the same point");
        by_depth[t.round() as usize - 1] += 1.0;
    }
    for (found, expected) in by_depth.into_iter().zip([0.3, 0.7 * 0.3, 0.7 * 0.7, 0.0f64]) {
        let deviation = (expected * (1.0 - expected) / rays as f64).sqrt();
        assert!((found / rays as f64 - expected).abs() <= 4.0 * deviation, "{by_depth:?}");
    }
}

#[test]
#[ignore = "prints rays a second; run it alone"]
fn rays_a_second() {
    let mut random = Random(8);
    for (spheres, rings) in [(40, 50), (100, 71)] {
        let mut meshes: Vec<_> = (0..spheres)
            .map(|_| {
                (
                    Mesh::sphere(random.in_cube() * 3.0 - DVec3::Z * 6.0, 0.2 + 0.5 * random.unit(), rings),
                    white(),
                )
            })
            .collect();
        let ground = Mesh::rectangle(DVec3::new(-50.0, -3.0, 50.0), DVec3::X * 100.0, DVec3::Z * -100.0);
        meshes.push((ground, white()));
        let scene = scene_of(meshes);
        let start = std::time::Instant::now();
        let tracer = Tracer::new(scene.clone());
        println!("{} triangles, built in {:?}", scene.triangles.len(), start.elapsed());
        let rate = |what: &str, rays: usize, start: std::time::Instant| {
            println!("{what:>28}: {:.2} M/s", rays as f64 / start.elapsed().as_secs_f64() * 1e-6);
        };

        let side = 1000;
        let start = std::time::Instant::now();
        let coherent = |k: usize| {
            let slope = DVec2::new((k % side) as f64, (k / side) as f64) / side as f64 * 1.2 - 0.6;
            ray(DVec3::ZERO, slope.extend(-1.0))
        };
        let hits: Vec<_> = (0..side * side).filter_map(|k| tracer.first_hit(&coherent(k))).collect();
        rate("pinhole first hit", side * side, start);

        let start = std::time::Instant::now();
        let mut sum = 0;
        for k in 0..side * side / 16 {
            for _ in 0..16 {
                let Ray { direction, .. } = coherent(k * 16);
                let u = DVec3::new(random.unit() - 0.5, random.unit() - 0.5, 0.0) * 0.1;
                sum += usize::from(tracer.first_hit(&ray(u, direction * 4.0 - u)).is_some());
            }
        }
        rate("thin lens first hit", side * side, start);

        let start = std::time::Instant::now();
        for hit in hits.iter().step_by(8) {
            for _ in 0..8 {
                let eye = DVec3::new(random.unit() - 0.5, random.unit() - 0.5, 0.0) * 0.1;
                sum += usize::from(tracer.is_occluded(hit.point, eye));
            }
        }
        rate("surface to aperture", hits.len(), start);

        let start = std::time::Instant::now();
        for _ in 0..200_000 {
            let origin = random.in_cube() * 3.0 - DVec3::Z * 6.0;
            sum += usize::from(tracer.first_hit(&ray(origin, random.direction())).is_some());
        }
        rate("random first hit", 200_000, start);
        println!("{sum} rays met something");
    }
}

/// Places of a 13 × 19 grid, jittered.
fn places(random: &mut Random) -> Vec<DVec2> {
    let jittered = |k: u32| DVec2::new(f64::from(k % 13) + random.unit(), f64::from(k / 13) + random.unit());
    (0..247).map(jittered).map(|p| 2.0 * p / DVec2::new(13.0, 19.0) - 1.0).collect()
}

#[test]
fn sight_is_what_single_rays_see() {
    let mut random = Random(5);
    let (mut asked, mut hidden, mut wrong) = (0, 0, 0);
    for (round, offset) in OFFSETS.into_iter().cycle().take(300).enumerate() {
        let mut mesh = random_triangles(&mut random, 60, if round % 2 == 0 { 0.2 } else { 1.0 });
        mesh.positions.iter_mut().for_each(|p| *p += offset);
        let material = if round % 3 == 0 { one_sided() } else { white() };
        let tracer = Tracer::new(scene_of([(mesh, material)]));
        let right = random.direction();
        let up = right.cross(random.direction()).normalize();
        let square = Square { center: offset + 1.5 * random.in_cube(), right: 0.3 * right, up: 0.3 * up };
        let found = places(&mut random);
        let places = TargetPoints::new(&found);
        let point = SurfacePoint { triangle: round as u32 % 60, barycentric: DVec2::splat(0.3) };
        let direction = random.in_cube();
        for infinite in [false, true] {
            let viewpoint = if infinite { Viewpoint::Infinity(direction) } else { Viewpoint::Surface(point) };
            let hidden_places = tracer.square_visibility(viewpoint, &square, &places).hidden;
            for (k, &place) in found.iter().enumerate() {
                let is_hidden = if infinite {
                    tracer.any_hit(&ray(square.world_position(place), direction))
                } else {
                    tracer.is_hidden_from(point, square.world_position(place))
                };
                asked += 1;
                hidden += u32::from(is_hidden);
                wrong += u32::from(is_hidden != hidden_places.contains(k));
            }
        }
    }
    assert!(hidden > asked / 10 && hidden < asked * 9 / 10, "{hidden} of {asked}");
    assert!(wrong <= asked / 10_000, "{wrong} of {asked}: only rays that graze an edge may differ");
}

#[test]
fn many_viewpoints_see_what_each_sees_alone() {
    let mut random = Random(7);
    let (mut partial, mut missed) = (0, 0);
    for (round, offset) in OFFSETS.into_iter().cycle().take(60).enumerate() {
        let mut mesh = random_triangles(&mut random, 400, 0.15);
        mesh.positions.iter_mut().for_each(|p| *p += offset);
        let material = if round % 3 == 0 { one_sided() } else { white() };
        let tracer = Tracer::new(scene_of([(mesh, material)]));
        let toward = random.direction();
        let right = toward.any_orthonormal_vector();
        let up = toward.cross(right);
        let square = Square { center: offset + 3.0 * toward, right: 0.4 * right, up: 0.4 * up };
        let places = TargetPoints::new(&places(&mut random));
        let of_triangle =
            |triangle: u32| Viewpoint::Surface(SurfacePoint { triangle, barycentric: DVec2::splat(0.3) });
        let mut viewpoints: Vec<_> = (0..9).map(|k| of_triangle(40 * k)).collect();
        if round % 2 == 1 {
            viewpoints.push(Viewpoint::Infinity(0.1 * random.in_cube() - toward));
        }
        let occluders = tracer.square_occluders(&viewpoints, &square).expect("all are on one side");
        let of_first = tracer.square_occluders(&viewpoints[..1], &square).expect("it is on one side");
        for &viewpoint in &viewpoints {
            let alone = tracer.square_visibility(viewpoint, &square, &places);
            assert_eq!(occluders.visibility(viewpoint, &places), alone, "{round}: {viewpoint:?}");
            partial += u32::from(!alone.hidden.is_empty() && alone.hidden != places.all());
            missed += u32::from(of_first.visibility(viewpoint, &places) != alone);
        }
    }
    assert!(partial > 200, "{partial} see a part");
    assert!(missed > 200, "the control: what stands before one viewpoint is not all, {missed}");
    let tracer = Tracer::new(scene_of([(random_triangles(&mut random, 50, 0.5), white())]));
    let square = Square { center: DVec3::ZERO, right: DVec3::X, up: DVec3::Y };
    let sides = [DVec3::Z, DVec3::NEG_Z].map(Viewpoint::Infinity);
    assert!(tracer.square_occluders(&sides, &square).is_none());
    assert!(tracer.square_occluders(&[], &square).is_none());
}

#[test]
fn no_place_shows_between_triangles() {
    let mut random = Random(6);
    let tracer = Tracer::new(scene_of([
        (Mesh::sphere(DVec3::ZERO, 1.0, 12), white()),
        (Mesh::rectangle(DVec3::new(-0.1, -0.1, 0.0), 0.2 * DVec3::X, 0.2 * DVec3::Y), white()),
    ]));
    let inner = tracer.scene().triangles.len() as u32 - 1;
    for _ in 0..2000 {
        let toward = random.in_cube().normalize_or(DVec3::X);
        let right = toward.any_orthonormal_vector() * 0.7;
        let square = Square { center: 3.0 * toward, right, up: toward.cross(right) };
        let places = TargetPoints::new(&places(&mut random));
        let point = SurfacePoint { triangle: inner, barycentric: DVec2::new(random.unit(), 0.0) };
        let inside = tracer.square_visibility(Viewpoint::Surface(point), &square, &places).hidden;
        assert_eq!(inside, places.all());
        let outside = tracer.square_visibility(Viewpoint::Infinity(toward), &square, &places).hidden;
        assert!(outside.is_empty());
    }
}

#[test]
fn sight_goes_through_what_is_cut_away() {
    let place = TargetPoints::new(&[DVec2::ZERO, DVec2::splat(0.5)]);
    let square = Square { center: DVec3::new(0.0, 0.0, 5.0), right: 0.1 * DVec3::X, up: 0.1 * DVec3::Y };
    let toward = Viewpoint::Surface(SurfacePoint { triangle: 4, barycentric: DVec2::splat(0.3) });
    for (opacity, hidden) in [(0.4, 0), (0.6, 2)] {
        let tracer = window(AlphaMode::Mask(0.5), opacity);
        let found = tracer.square_visibility(toward, &square, &place).hidden;
        assert_eq!(found.iter().count(), hidden);
    }
}

#[test]
fn panes_let_their_shares_through() {
    // Three panes one behind the other, the last over the right half alone.
    let pane = |opacity: f32, z: f64, left: f64| {
        let glass = Material {
            alpha: AlphaMode::Blend,
            base_color: glam::Vec4::new(1.0, 1.0, 1.0, opacity),
            ..white()
        };
        (Mesh::rectangle(DVec3::new(left, -9.0, z), 9.0 * DVec3::X, 18.0 * DVec3::Y), glass)
    };
    let card = (Mesh::rectangle(DVec3::new(-1.0, -1.0, 0.0), 2.0 * DVec3::X, 2.0 * DVec3::Y), white());
    let tracer =
        Tracer::new(scene_of([card, pane(0.25, 1.0, -4.5), pane(0.5, 2.0, -4.5), pane(0.9, 3.0, 0.0)]));
    let square = Square { center: DVec3::new(0.0, 0.0, 5.0), right: DVec3::X, up: DVec3::Y };
    let places = TargetPoints::new(&[DVec2::new(-0.7, 0.3), DVec2::new(0.8, -0.4)]);
    let from = Viewpoint::Surface(SurfacePoint { triangle: 0, barycentric: DVec2::splat(0.3) });
    let sight = tracer.square_visibility(from, &square, &places);
    assert!(sight.hidden.is_empty(), "half there is not there and not away");
    let shares = sight.shares.expect("there are panes");
    assert!((shares[0] - 0.375).abs() < 1e-6 && (shares[1] - 0.0375).abs() < 1e-6, "{:?}", &shares[..2]);
    // Rays by chance have the same mean.
    let passes = (0..4000).filter(|k| {
        let source = square.world_position(DVec2::new(-0.9 + f64::from(*k) * 2e-4, 0.3));
        !tracer.is_hidden_from(SurfacePoint { triangle: 0, barycentric: DVec2::splat(0.3) }, source)
    });
    let mean = passes.count() as f64 / 4000.0;
    assert!((mean - 0.375).abs() < 0.03, "{mean}");
}

#[test]
fn an_eye_passes_backs_and_light_does_not() {
    // A card that faces +z, over a floor that faces the same way.
    let card = Mesh::rectangle(DVec3::new(-1.0, -1.0, 0.0), 2.0 * DVec3::X, 2.0 * DVec3::Y);
    let floor = Mesh::rectangle(DVec3::new(-2.0, -2.0, -1.0), 4.0 * DVec3::X, 4.0 * DVec3::Y);
    let scene = scene_of([(card, one_sided()), (floor, one_sided())]);
    let shown = Arc::new(Scene { back_faces: scene::BackFaces::Show, ..(*scene).clone() });
    let (tracer, showing) = (Tracer::new(scene), Tracer::new(shown));
    let (above, below) = (DVec3::new(0.3, 0.2, 2.0), DVec3::new(0.3, 0.2, -3.0));
    let first = |tracer: &Tracer, from: DVec3| {
        tracer
            .first_hit(&ray(from, if from.z > 0.0 { -DVec3::Z } else { DVec3::Z }))
            .map(|hit| hit.point.triangle / 2)
    };
    assert_eq!((first(&tracer, above), first(&tracer, below)), (Some(0), None));
    assert_eq!((first(&showing, above), first(&showing, below)), (Some(0), Some(1)));
    let on = |triangle: u32| SurfacePoint { triangle, barycentric: DVec2::splat(0.3) };
    let (on_card, on_floor) = (on(0), on(2));
    assert!(!tracer.is_hidden_from(on_card, above) && !showing.is_hidden_from(on_card, above));
    assert!(tracer.is_hidden_from(on_card, below), "its own back");
    assert!(tracer.is_hidden_from(on_floor, above) && tracer.is_occluded(on_floor, above), "behind the card");
    assert!(showing.is_hidden_from(on_card, below), "the floor's back is in the way");
    // From beneath, light that comes up to the card is stopped by the floor; an eye would see through it.
    assert!(tracer.is_occluded(on_card, below));
    // Turned round, the card no longer hides the floor, but still shades it.
    let turned = Mesh::rectangle(DVec3::new(-1.0, -1.0, 0.0), 2.0 * DVec3::Y, 2.0 * DVec3::X);
    let floor = Mesh::rectangle(DVec3::new(-2.0, -2.0, -1.0), 4.0 * DVec3::X, 4.0 * DVec3::Y);
    let tracer = Tracer::new(scene_of([(turned, one_sided()), (floor, one_sided())]));
    assert!(!tracer.is_hidden_from(on_floor, above) && tracer.is_occluded(on_floor, above));
    assert_eq!(first(&tracer, above), Some(1));
}
