//! From texels to the surface and back: exact areas, centroids, gutters.

use crate::Test;
use crate::layout::unwrap;
use crate::meshes::{bare, grid, scene, soup, sphere};
use atlas::{Atlas, Density, NO_TEXEL, UnwrapOptions};
use glam::{DVec2, DVec3, Vec2};
use scene::Scene;
use std::time::Instant;

pub const TESTS: &[Test] = &[
    ("surface::a_square_covers_its_exact_area", a_square_covers_its_exact_area),
    ("surface::texels_sum_to_the_mesh", texels_sum_to_the_mesh),
    ("surface::a_texel_is_recovered_from_its_surface_point", a_texel_is_recovered_from_its_surface_point),
    ("surface::collapsed_places_keep_their_area", collapsed_places_keep_their_area),
    ("surface::gutters_take_the_nearest_covered_texel", gutters_take_the_nearest_covered_texel),
    ("surface::a_sphere_of_80k_triangles_is_timed", a_sphere_of_80k_triangles_is_timed),
];

/// World area of the scene's triangles, those that are not finite aside.
pub fn mesh_area(scene: &Scene) -> f64 {
    let areas = (0..scene.triangles.len() as u32).map(|t| 0.5 * scene.area_normal(t).length());
    areas.filter(|a| a.is_finite()).sum()
}

/// P1: areas sum to the mesh's, barycentrics lie inside, and every texel is found again.
pub fn check_surface(scene: &Scene, atlas: &Atlas) {
    let texels = atlas.texels(scene);
    let (sum, mesh): (f64, f64) = (texels.iter().map(|t| t.area).sum(), mesh_area(scene));
    assert!((sum - mesh).abs() <= 1e-9 * mesh, "{sum} of {mesh}");
    for texel in &texels {
        let [wa, wb, wc] = texel.centroid.weights();
        // wa is formed as a difference, which rounds.
        assert!(wa >= -1e-15 && wb >= 0.0 && wc >= 0.0, "{:?}", texel.centroid);
        assert!(texel.area > 0.0);
        let at = atlas.position_of(texel.centroid) - DVec2::new(texel.x.into(), texel.y.into());
        assert!(
            at.cmpge(DVec2::splat(-1e-3)).all() && at.cmple(DVec2::splat(1.001)).all(),
            "{texel:?} at {at}"
        );
    }
}

fn a_square_covers_its_exact_area() {
    let scene = scene(vec![bare(grid(1, 2.0, |_, _| 0.0))]);
    let place = |x: f32, y: f32| Vec2::new(1.25 + x, 2.5 + y);
    // 4 × 3 texels for a square of 2 × 2: a texel is 1/3 of a unit of area.
    let uv = scene.triangles.iter().map(|t| t.vertices.map(|v| scene.positions[v as usize].as_vec3() / 2.0));
    let corners: Vec<_> = uv.map(|t| t.map(|p| place(4.0 * p.x, 3.0 * p.z))).collect();
    let atlas = Atlas::new([8, 8], corners, vec![0, 0], &[0], 2.0);
    assert_eq!(atlas.charts[0].bounds, [1..6, 2..6]);
    let map = atlas.texel_map(&scene);
    assert_eq!(map.texels.len(), 5 * 4);
    for texel in &map.texels {
        let overlap = |low: f64, high: f64, at: u32| high.min(f64::from(at) + 1.0) - low.max(at.into());
        let covered = overlap(1.25, 5.25, texel.x) * overlap(2.5, 5.5, texel.y);
        assert!((texel.area - covered / 3.0).abs() < 1e-14, "{texel:?}");
    }
    let inner = map.texel_at(2, 3).unwrap();
    assert!((atlas.position_of(inner.centroid) - DVec2::new(2.5, 3.5)).length() < 1e-12);
    assert!(map.texel_at(0, 0).is_none() && map.texel_at(8, 3).is_none());
    let index = map.index[3 * 8 + 2] as usize;
    assert_eq!(map.texels[index], *inner);
    assert!((inner.centroid.position(&scene) - DVec3::new(0.625, 0.0, 2.0 / 3.0)).length() < 1e-12);
}

fn texels_sum_to_the_mesh() {
    let wave = |x: f64, z: f64| 0.2 * (9.0 * x).sin() * (7.0 * z).cos();
    let needles = soup((0..50).map(|i| {
        let (at, thin) = (DVec3::splat(f64::from(i)), 0.1f64.powi(i / 5));
        [at, at + DVec3::X * 3.0, at + DVec3::new(1.0, thin, 0.0)]
    }));
    for piece in [sphere(30, 1.0, DVec3::ZERO), bare(grid(40, 1.0, wave)), grid(40, 1.0, wave), needles] {
        let scene = scene(vec![piece]);
        for density in [Density::Auto, Density::Side(64), Density::TexelsPerUnit(3.3)] {
            let atlas = unwrap(&scene, &UnwrapOptions { density, ..UnwrapOptions::default() });
            check_surface(&scene, &atlas);
        }
    }
}

fn a_texel_is_recovered_from_its_surface_point() {
    let scene = scene(vec![sphere(20, 1.0, DVec3::ZERO)]);
    let atlas = unwrap(&scene, &UnwrapOptions::default());
    let map = atlas.texel_map(&scene);
    for texel in &map.texels {
        let at = atlas.position_of(texel.centroid);
        let again = map.texel_at(at.x as u32, at.y as u32).expect("a covered texel");
        assert!(
            (again.x.abs_diff(texel.x), again.y.abs_diff(texel.y)) <= (0, 0)
                || at.fract().min_element() < 1e-3
        );
        let (position, normal) =
            (texel.centroid.position(&scene), scene.area_normal(texel.centroid.triangle).normalize());
        assert!((position.length() - 1.0).abs() < 0.02);
        assert!(normal.dot(position) > 0.97, "normals point outwards");
    }
    // The surface is connected, so neighbouring texels of a chart are neighbours in the world.
    for pair in map.texels.windows(2) {
        let [a, b] = pair else { unreachable!() };
        let chart = |t: &atlas::AtlasTexel| atlas.chart_of[t.centroid.triangle as usize];
        if a.y == b.y && a.x + 1 == b.x && chart(a) == chart(b) {
            let [p, q] = [a, b].map(|texel| texel.centroid.position(&scene));
            assert!((p - q).length() < 6.0 / atlas.density, "{a:?} {b:?}");
        }
    }
}

fn collapsed_places_keep_their_area() {
    let scene = scene(vec![soup([[DVec3::ZERO, DVec3::X, DVec3::Y], [DVec3::ZERO, DVec3::X, DVec3::Z]])]);
    let corners = vec![[Vec2::new(1.5, 1.25); 3], [Vec2::ZERO, Vec2::new(4.0, 4.0), Vec2::new(2.0, 2.0)]];
    let texels = Atlas::new([4, 4], corners, vec![0, 1], &[0, 0], 1.0).texels(&scene);
    let found: Vec<_> = texels.iter().map(|t| (t.x, t.y, t.area, t.centroid.triangle)).collect();
    assert_eq!(found, [(1, 1, 0.5, 0), (2, 2, 0.5, 1)]);
}

fn gutters_take_the_nearest_covered_texel() {
    let scene = scene(vec![sphere(12, 1.0, DVec3::ZERO), grid(3, 1.0, |_, _| 0.0)]);
    let atlas = unwrap(&scene, &UnwrapOptions { density: Density::Side(256), ..UnwrapOptions::default() });
    let map = atlas.texel_map(&scene);
    let width = atlas.width;
    let mut data: Vec<u32> = (0..width * atlas.height).collect();
    data.iter_mut().zip(&map.index).filter(|(_, i)| **i == NO_TEXEL).for_each(|(d, _)| *d = u32::MAX);
    atlas.dilate(&map, &mut data);
    let covered: Vec<(i64, i64)> = map.texels.iter().map(|t| (t.x.into(), t.y.into())).collect();
    let distance = |a: (i64, i64), b: (i64, i64)| (a.0 - b.0).pow(2) + (a.1 - b.1).pow(2);
    let radius = i64::from(atlas::DILATION_RADIUS);
    let place = |i: u32| (i64::from(i % width), i64::from(i / width));
    for (i, &value) in data.iter().enumerate().step_by(7) {
        let here = place(i as u32);
        let nearest = covered.iter().map(|&c| distance(here, c)).min().unwrap();
        match value {
            u32::MAX => assert!(nearest > radius * radius),
            source => assert_eq!(distance(here, place(source)), nearest),
        }
    }
    // An update through the sources of one texel is the same as dilating everything.
    let source = map.dilations[map.dilations.len() / 2].source;
    let mut updated = data.clone();
    data[source as usize] = 77;
    atlas.dilate(&map, &mut data);
    updated[source as usize] = 77;
    map.gutter_of(source).iter().for_each(|d| updated[d.texel as usize] = 77);
    assert!(updated == data && !map.gutter_of(source).is_empty());
}

fn a_sphere_of_80k_triangles_is_timed() {
    let scene = scene(vec![sphere(143, 1.0, DVec3::ZERO)]);
    for child in [Some(std::env::current_exe().unwrap()), None] {
        let how = if child.is_some() { "children" } else { "this process" };
        let start = Instant::now();
        let atlas = unwrap(&scene, &UnwrapOptions { child, ..UnwrapOptions::default() });
        let unwrapped = start.elapsed();
        let start = Instant::now();
        let map = atlas.texel_map(&scene);
        println!(
            "  {} triangles in {how}: unwrapped in {unwrapped:.2?} to {}×{}, {} charts, {:.0} % covered; texels in {:.2?}",
            scene.triangles.len(),
            atlas.width,
            atlas.height,
            atlas.charts.len(),
            100.0 * map.texels.len() as f64 / f64::from(atlas.width * atlas.height),
            start.elapsed()
        );
        assert!(atlas.notes.is_empty(), "{:?}", atlas.notes);
        check_surface(&scene, &atlas);
    }
}
