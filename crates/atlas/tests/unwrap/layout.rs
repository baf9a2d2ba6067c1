//! Charts do not overlap, keep their gutter, have one density, and keep sound texture coordinates.

use crate::Test;
use crate::meshes::{bare, grid, mirrored, scene, soup, sphere};
use atlas::{Atlas, Density, UnwrapOptions, UvPolicy};
use glam::{DVec2, DVec3, Vec2};
use progress::Unwatched;
use scene::Scene;

pub const TESTS: &[Test] = &[
    ("layout::no_texel_centre_lies_in_two_triangles", no_texel_centre_lies_in_two_triangles),
    ("layout::the_overlap_check_detects_overlaps", the_overlap_check_detects_overlaps),
    ("layout::mirrored_instances_have_places_of_their_own", mirrored_instances_have_places_of_their_own),
    ("layout::sound_coordinates_are_reused", sound_coordinates_are_reused),
    ("layout::unsound_coordinates_are_not", unsound_coordinates_are_not),
    ("layout::density_is_uniform_and_as_requested", density_is_uniform_and_as_requested),
    ("layout::too_fine_a_density_is_reduced", too_fine_a_density_is_reduced),
    ("layout::many_small_charts_fit", many_small_charts_fit),
];

pub fn unwrap(scene: &Scene, options: &UnwrapOptions) -> Atlas {
    Atlas::unwrap(scene, options, &Unwatched).expect("every scene with a triangle has an atlas")
}

/// The triangles that hold a texel's centre, texel by texel: pairs of different triangles, borders aside.
pub fn centres_in_two_triangles(atlas: &Atlas) -> usize {
    let mut owner = vec![u32::MAX; (atlas.width * atlas.height) as usize];
    let mut doubled = 0;
    for (triangle, corners) in atlas.corners.iter().enumerate() {
        let corners = corners.map(Vec2::as_dvec2);
        let [a, b, c] = corners;
        let area = (b - a).perp_dot(c - a);
        if area == 0.0 {
            continue;
        }
        let low = a.min(b).min(c);
        let high = a.max(b).max(c);
        for y in low.y as u32..(high.y.ceil() as u32).min(atlas.height) {
            for x in low.x as u32..(high.x.ceil() as u32).min(atlas.width) {
                let p = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                // Strictly inside by more than f32 can misplace a corner.
                let inside = (0..3).all(|k| {
                    let (from, to) = (corners[k], corners[(k + 1) % 3]);
                    (to - from).perp_dot(p - from) * area.signum() > 2e-3 * (to - from).length()
                });
                let place = &mut owner[(y * atlas.width + x) as usize];
                if inside {
                    doubled += usize::from(*place != u32::MAX);
                    *place = triangle as u32;
                }
            }
        }
    }
    doubled
}

/// The least number of empty texels between texels of two charts, if below `gutter`.
fn least_gap(atlas: &Atlas, scene: &Scene, gutter: i32) -> Option<i32> {
    let map = atlas.texel_map(scene);
    let chart_at = |x: i32, y: i32| {
        let texel = (x >= 0 && y >= 0).then(|| map.texel_at(x as u32, y as u32))??;
        Some(atlas.chart_of[texel.centroid.triangle as usize])
    };
    let mut least = None;
    for texel in &map.texels {
        let (x, y) = (texel.x as i32, texel.y as i32);
        let own = chart_at(x, y);
        for (dx, dy) in (0..=gutter).flat_map(|dy| (-gutter..=gutter).map(move |dx| (dx, dy))) {
            let other = chart_at(x + dx, y + dy);
            if other.is_some() && other != own {
                let gap = dx.abs().max(dy) - 1;
                least = Some(least.map_or(gap, |least: i32| least.min(gap)));
            }
        }
    }
    least
}

fn mixed_scene() -> Scene {
    let wave = |x: f64, z: f64| 0.2 * (9.0 * x).sin() * (7.0 * z).cos();
    scene(vec![
        sphere(24, 0.7, DVec3::ZERO),
        bare(grid(30, 2.0, wave)),
        grid(4, 3.0, |_, _| 0.0),
        mirrored(sphere(9, 0.2, DVec3::X)),
        soup((0..40).map(|i| {
            let at = DVec3::splat(f64::from(i));
            [at, at + DVec3::X * 0.02, at + DVec3::new(0.01, 0.3, 0.0)]
        })),
    ])
}

fn no_texel_centre_lies_in_two_triangles() {
    let scene = mixed_scene();
    for gutter in [2, 4, 7] {
        let atlas = unwrap(&scene, &UnwrapOptions { gutter, ..UnwrapOptions::default() });
        assert_eq!(centres_in_two_triangles(&atlas), 0);
        assert_eq!(least_gap(&atlas, &scene, gutter as i32 - 1), None);
        for (triangle, corners) in atlas.corners.iter().enumerate() {
            let [x, y] = &atlas.charts[atlas.chart_of[triangle] as usize].bounds;
            for c in corners {
                assert!(c.x >= x.start as f32 && c.x <= x.end as f32, "bounds hold the chart");
                assert!(c.y >= y.start as f32 && c.y <= y.end as f32, "bounds hold the chart");
            }
        }
    }
}

fn the_overlap_check_detects_overlaps() {
    let scene = mixed_scene();
    let mut atlas = unwrap(&scene, &UnwrapOptions::default());
    // The first chart, moved onto the second one.
    let middle = |chart: &atlas::Chart| {
        let [x, y] = chart.bounds.clone().map(|range| (range.start + range.end) as f32 / 2.0);
        Vec2::new(x, y)
    };
    let step = middle(&atlas.charts[1]) - middle(&atlas.charts[0]);
    let size = Vec2::new(atlas.width as f32, atlas.height as f32);
    for (corners, _) in atlas.corners.iter_mut().zip(&atlas.chart_of).filter(|(_, chart)| **chart == 0) {
        corners.iter_mut().for_each(|c| *c = (*c + step).clamp(Vec2::ZERO, size));
    }
    assert!(centres_in_two_triangles(&atlas) > 0);
    assert!(least_gap(&atlas, &scene, 3).is_some());
}

fn mirrored_instances_have_places_of_their_own() {
    let wave = |x: f64, z: f64| 0.3 * x * z;
    let scene = scene(vec![grid(6, 1.0, wave), mirrored(grid(6, 1.0, wave)), grid(6, 1.0, wave)]);
    let atlas = unwrap(&scene, &UnwrapOptions::default());
    assert_eq!(centres_in_two_triangles(&atlas), 0);
    let parts: Vec<u32> = atlas.charts.iter().map(|c| c.part).collect();
    assert_eq!(parts, [0, 1, 2], "each keeps its coordinates as a chart of its own");
    let clockwise = |t: usize| {
        let [a, b, c] = atlas.corners[t];
        (b - a).perp_dot(c - a) > 0.0
    };
    assert!((0..atlas.corners.len()).all(clockwise), "mirrored coordinates are turned over");
}

fn sound_coordinates_are_reused() {
    let scene = scene(vec![grid(8, 1.0, |x, _| 0.1 * (6.0 * x).sin())]);
    let atlas = unwrap(&scene, &UnwrapOptions::default());
    assert_eq!(atlas.charts.len(), 1);
    for (t, corners) in atlas.corners.iter().enumerate() {
        let uv = scene.corner_uv(t as u32, 0);
        for k in 0..3 {
            let (atlas_edge, uv_edge) = (corners[(k + 1) % 3] - corners[k], uv[(k + 1) % 3] - uv[k]);
            let along =
                |v: Vec2| (v.x.abs() > 1e-6 * v.length() * 100.0, v.y.abs() > 1e-6 * v.length() * 100.0);
            let (a, b) = (along(atlas_edge), along(uv_edge));
            assert!(a == b || a == (b.1, b.0), "an edge along an axis of the artist's stays along one");
        }
    }
    let ignored = unwrap(&scene, &UnwrapOptions { uv: UvPolicy::Ignore, ..UnwrapOptions::default() });
    assert_ne!(ignored.corners, atlas.corners);
}

fn unsound_coordinates_are_not() {
    type Spoil = fn(usize, &mut Vec2);
    let spoil: [(&str, Spoil); 5] = [
        ("overlap", |i, c| {
            if i % 2 == 0 {
                c.x = 1.0 - c.x
            }
        }),
        ("not finite", |i, c| {
            if i == 7 {
                c.x = f32::NAN
            }
        }),
        ("outside", |_, c| c.x += 0.5),
        ("collapsed", |_, c| c.y = 0.5),
        ("stretched", |_, c| c.y = c.y.powi(12)),
    ];
    for (what, spoil) in spoil {
        let mut piece = grid(8, 1.0, |x, z| 0.2 * (3.0 * x).sin() * (3.0 * z).sin());
        piece.uv.iter_mut().flatten().enumerate().for_each(|(i, c)| spoil(i, c));
        let with = unwrap(&scene(vec![piece]), &UnwrapOptions::default());
        let without = bare(grid(8, 1.0, |x, z| 0.2 * (3.0 * x).sin() * (3.0 * z).sin()));
        let without = unwrap(&scene(vec![without]), &UnwrapOptions::default());
        assert_eq!(with.hash, without.hash, "{what}");
    }
}

fn density_is_uniform_and_as_requested() {
    let scene = mixed_scene();
    let options = UnwrapOptions { density: Density::TexelsPerUnit(100.0), ..UnwrapOptions::default() };
    let atlas = unwrap(&scene, &options);
    assert_eq!(atlas.density, 100.0);
    assert!(atlas.notes.is_empty(), "{:?}", atlas.notes);
    let mut areas = vec![(0.0, 0.0); atlas.charts.len()];
    for (t, corners) in atlas.corners.iter().enumerate() {
        let [a, b, c] = corners.map(Vec2::as_dvec2);
        let sum = &mut areas[atlas.chart_of[t] as usize];
        sum.0 += 0.5 * (b - a).perp_dot(c - a);
        sum.1 += 0.5 * scene.area_normal(t as u32).length();
    }
    for (texels, world) in areas {
        assert!((texels / world / 1e4 - 1.0).abs() < 1e-3, "{texels} texels for {world}");
    }
    let options = UnwrapOptions { density: Density::Side(300), ..UnwrapOptions::default() };
    let atlas = unwrap(&scene, &options);
    assert!(atlas.width <= 300 && atlas.height <= 300 && atlas.height.max(atlas.width) > 250);
}

fn too_fine_a_density_is_reduced() {
    let scene = scene(vec![grid(2, 1.0, |_, _| 0.0)]);
    let options = UnwrapOptions { density: Density::TexelsPerUnit(1e6), ..UnwrapOptions::default() };
    let atlas = unwrap(&scene, &options);
    assert!(atlas.width <= atlas::MAX_SIDE && atlas.height <= atlas::MAX_SIDE && atlas.width > 7000);
    assert!(atlas.notes.iter().any(|n| n.contains("8192")), "{:?}", atlas.notes);
}

fn many_small_charts_fit() {
    let scene = scene(vec![soup((0..30_000).map(|i| {
        let at = DVec3::new(f64::from(i % 173), f64::from(i / 173), f64::from(i % 7));
        [at, at + DVec3::X, at + DVec3::new(0.3, 0.4 + f64::from(i % 5), 0.2)]
    }))]);
    let atlas = unwrap(&scene, &UnwrapOptions::default());
    assert_eq!(atlas.charts.len(), 30_000);
    assert!(atlas.width <= 4096 && atlas.height <= 4096);
    assert_eq!(centres_in_two_triangles(&atlas), 0);
    assert_eq!(least_gap(&atlas, &scene, 3), None);
}
