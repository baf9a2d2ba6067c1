//! A synthetic capture: photographs of a wall.

use glam::{DMat3, DQuat, DVec3};
use image::{Rgb, RgbImage};
use std::path::Path;

/// Width and height of the photographs, and the focal length of their lens, px.
pub const SIZE: [u32; 2] = [120, 80];
const FOCAL: f64 = 100.0;

/// Linear radiance of the wall at a position.
pub fn wall(x: f64, y: f64) -> [f64; 3] {
    let wave = |k: f64| 0.3 + 0.2 * (k * x).sin() * (1.3 * k * y).cos();
    [wave(3.0), wave(2.0), 0.5 * wave(1.5) + 0.1]
}

/// Pose of photograph k, in a ring and aimed at the wall's centre; axes right, down and forward.
fn camera(k: usize) -> (DVec3, DMat3) {
    let angle = k as f64 * 1.1;
    let center = DVec3::new(0.6 * angle.cos(), 0.4 * angle.sin(), 2.0);
    let forward = -center.normalize();
    let right = forward.cross(DVec3::Y).normalize();
    (center, DMat3::from_cols(right, forward.cross(right), forward))
}

/// Exposure of photograph k, stops.
fn stops(k: usize) -> f64 {
    0.2 * (k as f64 - 2.5)
}

fn photograph(k: usize) -> RgbImage {
    let (center, axes) = camera(k);
    RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let at = |at: u32, side: u32| (f64::from(at) + 0.5 - f64::from(side) / 2.0) / FOCAL;
        let direction = axes * DVec3::new(at(x, SIZE[0]), at(y, SIZE[1]), 1.0);
        let place = center - direction * (center.z / direction.z);
        Rgb(wall(place.x, place.y).map(|linear| {
            let shown = (linear * stops(k).exp2()).min(1.0);
            let encoded =
                if shown <= 0.0031308 { 12.92 * shown } else { 1.055 * shown.powf(1.0 / 2.4) - 0.055 };
            (encoded * 255.0).round() as u8
        }))
    })
}

/// Six photographs, COLMAP's cameras, and the wall in front of them.
pub fn write(folder: &Path) {
    std::fs::create_dir_all(folder.join("images")).unwrap();
    std::fs::create_dir_all(folder.join("sparse/0")).unwrap();
    let mut images = String::new();
    for k in 0..6 {
        photograph(k).save(folder.join(format!("images/{k}.png"))).unwrap();
        let (center, axes) = camera(k);
        let rotation = DQuat::from_mat3(&axes).inverse();
        let (q, t) = (rotation, rotation * -center);
        images += &format!("{} {} {} {} {} {} {} {} 1 {k}.png\n\n", k + 1, q.w, q.x, q.y, q.z, t.x, t.y, t.z);
    }
    let [width, height] = SIZE;
    let lens = format!("1 PINHOLE {width} {height} {FOCAL} {FOCAL} {} {}\n", width / 2, height / 2);
    std::fs::write(folder.join("sparse/0/cameras.txt"), lens).unwrap();
    std::fs::write(folder.join("sparse/0/images.txt"), images).unwrap();
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n-3 -2 0\n3 -2 0\n3 2 0\n-3 2 0\n4 0 1 2 3\n";
    std::fs::write(folder.join("mesh.ply"), ply).unwrap();
}
