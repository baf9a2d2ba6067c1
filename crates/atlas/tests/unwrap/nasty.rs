//! Every mesh gets an atlas, with children and without.

use crate::Test;
use crate::layout::unwrap;
use crate::meshes::{Piece, bare, grid, scene, soup, sphere};
use crate::surface::check_surface;
use atlas::{Atlas, AtlasError, UnwrapOptions};
use glam::{DVec3, Vec2};
use progress::Unwatched;
use scene::Scene;

pub const TESTS: &[Test] = &[
    ("nasty::every_mesh_gets_an_atlas", every_mesh_gets_an_atlas),
    ("nasty::triangles_without_area_get_places_without_area", triangles_without_area_get_places_without_area),
    ("nasty::no_triangle_is_an_error", no_triangle_is_an_error),
];

fn scaled(piece: Piece, scale: f64) -> Piece {
    Piece { positions: piece.positions.iter().map(|p| *p * scale).collect(), ..piece }
}

/// A piece and the same with every triangle copied, half of the copies turned over.
fn doubled(mut piece: Piece) -> Piece {
    let copies = piece
        .triangles
        .iter()
        .enumerate()
        .map(|(i, &[a, b, c])| if i % 2 == 0 { [a, c, b] } else { [b, c, a] });
    let copies: Vec<_> = copies.collect();
    piece.triangles.extend(copies);
    piece
}

fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

fn nasty_scenes() -> Vec<(&'static str, Scene)> {
    let single = || soup([[DVec3::ZERO, DVec3::X, DVec3::Y]]);
    let mut seed = 7;
    let mut point = || DVec3::new(random(&mut seed), random(&mut seed), random(&mut seed));
    let tangle = soup((0..500).map(|_| [point(), point(), point()]));
    // All corners shared at random: every edge is non-manifold.
    let shared: Vec<DVec3> = (0..20).map(|_| point()).collect();
    let mut knot =
        soup((0..400).map(|i| [shared[i % 20], shared[(i * 7 + 3) % 20], shared[(i * 11 + 8) % 20]]));
    knot.uv = Some(vec![Vec2::splat(0.5); knot.positions.len()]);
    let fan = soup((0..1500).map(|i| {
        let at = |i: i32| DVec3::new((f64::from(i) * 0.0042).cos(), (f64::from(i) * 0.0042).sin(), 0.0);
        [DVec3::ZERO, at(i), at(i + 1)]
    }));
    let mut broken = bare(grid(10, 1.0, |x, z| x * z));
    broken.positions[17] = DVec3::splat(f64::NAN);
    broken.positions[60].x = f64::INFINITY;
    broken.triangles[40] = [3, 3, 4];
    let moebius = |i: u32, side: f64| {
        let a = f64::from(i) * std::f64::consts::TAU / 60.0;
        let (c, s) = ((0.5 * a).cos() * side * 0.3, (0.5 * a).sin() * side * 0.3);
        DVec3::new((1.0 + c) * a.cos(), s, (1.0 + c) * a.sin())
    };
    let strip = soup((0..60).flat_map(|i| {
        let [a, b, c, d] = [moebius(i, -1.0), moebius(i, 1.0), moebius(i + 1, -1.0), moebius(i + 1, 1.0)];
        [[a, b, d], [a, d, c]]
    }));
    vec![
        ("single triangle", scene(vec![single()])),
        ("one-millionth of a unit", scene(vec![scaled(sphere(10, 1.0, DVec3::ZERO), 1e-6)])),
        ("1e-30", scene(vec![scaled(sphere(10, 1.0, DVec3::ZERO), 1e-30)])),
        ("1e15", scene(vec![scaled(sphere(10, 1.0, DVec3::ZERO), 1e15)])),
        ("far from the origin", scene(vec![sphere(10, 1.0, DVec3::splat(1e5))])),
        ("all degenerate", scene(vec![soup((0..99).map(|i| [DVec3::X * f64::from(i); 3]))])),
        ("a degenerate part beside a sound one", scene(vec![single(), soup([[DVec3::X; 3]]), single()])),
        ("10k copies of a face", scene(vec![soup((0..10_000).map(|_| [DVec3::ZERO, DVec3::X, DVec3::Y]))])),
        ("a sphere with every face doubled", scene(vec![doubled(sphere(12, 1.0, DVec3::ZERO))])),
        ("random soup", scene(vec![tangle])),
        ("a non-manifold knot", scene(vec![knot])),
        ("a fan of needles", scene(vec![fan])),
        (
            "needles",
            scene(vec![bare(grid(20, 1.0, |x, z| 1e-3 * x * z))]).tap(|s| {
                s.positions.iter_mut().for_each(|p| p.z *= 1e-7);
            }),
        ),
        ("broken corners", scene(vec![broken])),
        ("a Möbius strip", scene(vec![strip])),
        ("a plane beside a grain", scene(vec![grid(4, 1000.0, |_, _| 0.0), sphere(6, 1e-3, DVec3::ZERO)])),
    ]
}

trait Tap: Sized {
    fn tap(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }
}
impl Tap for Scene {}

fn every_mesh_gets_an_atlas() {
    for child in [None, Some(std::env::current_exe().unwrap())] {
        for (name, scene) in nasty_scenes() {
            let start = std::time::Instant::now();
            let atlas = unwrap(&scene, &UnwrapOptions { child: child.clone(), ..UnwrapOptions::default() });
            println!(
                "  {name}: {}×{}, {} charts, {:.2?} {:?}",
                atlas.width,
                atlas.height,
                atlas.charts.len(),
                start.elapsed(),
                atlas.notes
            );
            assert_eq!(atlas.corners.len(), scene.triangles.len());
            let size = Vec2::new(atlas.width as f32, atlas.height as f32);
            assert!(atlas.corners.iter().flatten().all(|c| c.cmpge(Vec2::ZERO).all() && c.cmple(size).all()));
            for (triangle, &chart) in scene.triangles.iter().zip(&atlas.chart_of) {
                assert_eq!(atlas.charts[chart as usize].part, triangle.part);
            }
            check_surface(&scene, &atlas);
        }
    }
}

fn triangles_without_area_get_places_without_area() {
    let mut piece = bare(grid(3, 1.0, |_, _| 0.0));
    piece.triangles.extend([[5, 5, 6], [1, 2, 3]]);
    let scene = scene(vec![piece]);
    let atlas = unwrap(&scene, &UnwrapOptions::default());
    let (sound, flat) = atlas.corners.split_at(18);
    let [a, b, c] = flat[0];
    assert!(a == b && b == c);
    assert!(sound.iter().flatten().any(|&corner| corner == a), "it lies in a neighbour's corner");
    assert_eq!(atlas.charts.len(), 1);
}

fn no_triangle_is_an_error() {
    let empty = Scene::default();
    assert!(matches!(
        Atlas::unwrap(&empty, &UnwrapOptions::default(), &Unwatched),
        Err(AtlasError::NoTriangles)
    ));
}
