//! Unwrapping as a whole, with the test program as its own child.

mod meshes;

use atlas::{Atlas, UnwrapOptions};
use glam::DVec3;
use progress::Unwatched;
use std::time::Instant;

fn main() {
    atlas::child::run_if_asked();
    for child in [false, true] {
        for n in [8u32, 40, 143] {
            let scene = meshes::scene(vec![meshes::sphere(n, 1.0, DVec3::ZERO)]);
            let options = UnwrapOptions {
                child: child.then(|| std::env::current_exe().unwrap()),
                ..UnwrapOptions::default()
            };
            let start = Instant::now();
            let atlas = Atlas::unwrap(&scene, &options, &Unwatched).unwrap();
            let took = start.elapsed();
            let start = Instant::now();
            let texels = atlas.texels(&scene);
            let took2 = start.elapsed();
            let area: f64 = texels.iter().map(|t| t.area).sum();
            let mesh: f64 =
                (0..scene.triangles.len() as u32).map(|t| 0.5 * scene.area_normal(t).length()).sum();
            println!(
                "{} tris child {child}: {took:?}, {}x{} {} charts density {:.1} cover {:.3}, texels {took2:?} area err {:e} notes {:?}",
                scene.triangles.len(),
                atlas.width,
                atlas.height,
                atlas.charts.len(),
                atlas.density,
                texels.len() as f64 / (atlas.width * atlas.height) as f64,
                area / mesh - 1.0,
                atlas.notes
            );
        }
    }
}
