//! Captures of made-up places: a light field, photographs with cameras and a mesh, a picture with depth.

use crate::endure::harness::made_files::{pfm, picture_with_depth, put};
use image::{Rgb, RgbImage};
use std::path::Path;

/// Writes all of them.
pub fn write(folder: &Path) -> Result<(), String> {
    put(folder, "depth/readme.txt", "")?;
    picture_with_depth(&folder.join("depth"), [60, 40])?;
    light_field(folder)?;
    photographs(folder)
}

/// 3 × 3 views of a card before a wall.
fn light_field(folder: &Path) -> Result<(), String> {
    const SIZE: [u32; 2] = [72, 54];
    let (near, far) = (1.5, -0.5);
    let shown = |x: u32, y: u32, [u, v]: [f64; 2]| {
        let of = |disparity: f64| [f64::from(x) + disparity * u, f64::from(y) + disparity * v];
        let wave =
            |[x, y]: [f64; 2], k: f64| (110.0 + 70.0 * (0.45 * k * x).sin() * (0.4 * k * y + k).cos()) as u8;
        let [x, y] = of(near);
        match (24.0..46.0).contains(&x) && (15.0..39.0).contains(&y) {
            true => (Rgb([wave([x, y], 1.0), wave([x, y], 1.4), 40]), near),
            false => (Rgb([60, wave(of(far), 0.8), wave(of(far), 1.1)]), far),
        }
    };
    put(folder, "views/readme.txt", "")?;
    for row in 0..3u32 {
        for column in 0..3u32 {
            let view = [f64::from(column) - 1.0, f64::from(row) - 1.0];
            save(
                &RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| shown(x, y, view).0),
                &folder.join(format!("views/{row:02}_{column:02}.png")),
            )?;
        }
    }
    put(folder, "views/disparity.pfm", pfm(SIZE, |x, y| shown(x, y, [0.0; 2]).1 as f32))
}

/// Three photographs of a wall from the side of each other, with COLMAP's cameras.
fn photographs(folder: &Path) -> Result<(), String> {
    const SIZE: [u32; 2] = [90, 60];
    const FOCAL: f64 = 75.0;
    let mut images = String::new();
    for k in 0..3u32 {
        let x = 0.4 * (f64::from(k) - 1.0);
        let color = |column: u32, row: u32| {
            let at = |at: u32, side: u32| 2.0 * (f64::from(at) + 0.5 - f64::from(side) / 2.0) / FOCAL;
            let [x, y] = [x + at(column, SIZE[0]), at(row, SIZE[1])];
            let wave = |k: f64| (110.0 + 80.0 * (k * x).sin() * (1.3 * k * y).cos()) as u8;
            Rgb([wave(3.0), wave(5.0), wave(1.5)])
        };
        put(folder, "photos/images/readme.txt", "")?;
        save(&RgbImage::from_fn(SIZE[0], SIZE[1], color), &folder.join(format!("photos/images/{k}.png")))?;
        // Looks down −Z from z = 2: turned by half a turn around x from COLMAP's axes.
        images += &format!("{} 0 1 0 0 {} 0 2 1 {k}.png\n\n", k + 1, -x);
    }
    let lens = format!("1 PINHOLE {} {} {FOCAL} {FOCAL} {} {}\n", SIZE[0], SIZE[1], SIZE[0] / 2, SIZE[1] / 2);
    put(folder, "photos/sparse/0/cameras.txt", lens)?;
    put(folder, "photos/sparse/0/images.txt", images)?;
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n-3 -2 0\n3 -2 0\n3 2 0\n-3 2 0\n4 0 1 2 3\n";
    put(folder, "photos/mesh.ply", ply)
}

fn save(picture: &RgbImage, file: &Path) -> Result<(), String> {
    picture.save(file).map_err(|e| format!("{}: {e}", file.display()))
}
