//! Between near and far: hedges, clipped trees, houses with lit windows, hills, the sky.

use super::ground::path_middle;
use super::light::sky;
use super::noise::{hash, noise, rough};
use super::solids::{ball, block, tapered};
use super::surface::{Object, Place, Shine, Skin, SkinShader, Surface};
use super::view::View;
use glam::Vec3;
use std::sync::Arc;

fn foliage(tint: Vec3) -> SkinShader {
    Arc::new(move |place: &Place| {
        let clump = 0.65 * noise(place.position * 16.0) + 0.35 * noise(place.position * 33.0);
        Skin::matt(place, tint * (0.35 + 1.7 * clump * clump))
    })
}

/// The clipped trees: depth, offset from the path's middle, height of the crown's middle, radius, stretch.
const TREES: [(f32, f32, f32, f32, f32); 10] = [
    (1.95, -0.78, 0.40, 0.155, 1.0),
    (2.35, 1.00, 0.36, 0.16, 1.0),
    (3.2, -0.86, 0.48, 0.20, 1.0),
    (3.6, 1.10, 0.42, 0.19, 1.0),
    (4.6, -0.95, 0.56, 0.24, 1.1),
    (2.7, -1.45, 0.42, 0.17, 2.3),
    (4.1, -1.75, 0.55, 0.20, 2.6),
    (5.4, -1.45, 0.60, 0.22, 2.7),
    (5.6, 1.55, 0.50, 0.22, 2.2),
    (6.6, -0.55, 0.40, 0.26, 1.2),
];

/// Middle and radius of the crowns, the nearest first.
pub fn crowns() -> Vec<(Vec3, f32)> {
    let crown =
        |(depth, offset, height, radius, _)| (Vec3::new(path_middle(depth) + offset, height, -depth), radius);
    TREES.into_iter().map(crown).collect()
}

/// Trees beside the path, each a stem with a crown.
pub fn trees() -> Object {
    let mut surfaces = Vec::new();
    let bark = Arc::new(|place: &Place| Skin::matt(place, Vec3::new(0.05, 0.035, 0.025)));
    for ((center, radius), (_, _, height, _, stretch)) in crowns().into_iter().zip(TREES) {
        let foot = center.with_y(0.0);
        let shader = foliage(Vec3::new(0.085, 0.19, 0.06));
        surfaces.push(ball(center, 20, [64, 36], shader, move |direction: Vec3| {
            let stretched = radius / Vec3::new(direction.x, direction.y / stretch, direction.z).length();
            stretched * (0.90 + 0.22 * noise(direction * 6.0 + foot * 3.0))
        }));
        let stem = [foot - Vec3::Y * 0.02, foot + Vec3::Y * height];
        surfaces.push(tapered(&stem, |_| radius * 0.11, 7, [6, 10], bark.clone()));
    }
    Object::baked("trees", surfaces)
}

/// A hedge along each side.
pub fn hedges() -> Object {
    let mut surfaces = Vec::new();
    for (side, near, far) in [(-1.0f32, 1.1f32, 6.0f32), (1.0, 1.5, 5.2)] {
        let shader = foliage(Vec3::new(0.075, 0.16, 0.05));
        surfaces.push(Surface::grid(12, 46, [26, 110], shader, |u, v| {
            let depth = near * (far / near).powf(v);
            // Around the section, over the top, from left to right.
            let around = (1.0 - u) * std::f32::consts::PI;
            let (sin, cos) = around.sin_cos();
            let square = |x: f32| x.signum() * x.abs().sqrt();
            let clump = 1.0 + 0.20 * (noise(Vec3::new(u * 7.0, depth * 12.0, side)) - 0.5);
            let close = if v == 0.0 || v == 1.0 { 0.55 } else { 1.0 };
            let middle = path_middle(depth) + side * 1.12;
            let x = middle + 0.13 * square(cos) * clump * close;
            Vec3::new(x, 0.20 * sin.max(0.0).sqrt() * clump * close, -depth)
        }));
    }
    Object::baked("hedges", surfaces)
}

/// A house: where, how large, how turned.
struct House {
    base: Vec3,
    half: Vec3,
    yaw: f32,
}

fn row_of_houses() -> Vec<House> {
    // Depth, x, half width, height, yaw.
    [
        (6.4, -2.55, 0.42, 0.66, 0.25),
        (6.9, -1.70, 0.36, 0.48, 0.10),
        (7.1, -0.90, 0.34, 0.62, -0.05),
        (7.2, -0.15, 0.36, 0.42, 0.0),
        (7.2, 0.55, 0.30, 0.54, -0.1),
        (7.1, 2.25, 0.36, 0.46, -0.2),
        (6.6, 2.95, 0.40, 0.60, -0.3),
    ]
    .map(|(depth, x, half, height, yaw)| House {
        base: Vec3::new(x, 0.0, -depth),
        half: Vec3::new(half, height, 0.25),
        yaw,
    })
    .into()
}

/// The houses' walls and roofs.
pub fn houses() -> Object {
    let mut surfaces = Vec::new();
    for (k, house) in row_of_houses().iter().enumerate() {
        let shade = 0.16 + 0.10 * hash(k as i32, 1, 1);
        let plaster: SkinShader =
            Arc::new(move |place: &Place| Skin::matt(place, Vec3::new(1.0, 0.85, 0.75) * shade));
        let tiles: SkinShader = Arc::new(|place: &Place| Skin::matt(place, Vec3::new(0.13, 0.06, 0.05)));
        surfaces.extend(block(house.base, house.half, house.yaw, [16, 20], &plaster));
        let turn = glam::Quat::from_rotation_y(house.yaw);
        let at = |x: f32, y: f32, z: f32| {
            house.base + turn * Vec3::new(x * house.half.x * 1.1, house.half.y + y, z * house.half.z * 1.2)
        };
        let ridge = house.half.x * 0.55;
        let (a, b) = (at(-1., 0., 1.), at(1., 0., 1.));
        let (c, d) = (at(1., 0., -1.), at(-1., 0., -1.));
        let (e, f) = (at(-1., ridge, 0.), at(1., ridge, 0.));
        surfaces.push(Surface::quad([a, b, f, e], [12, 8], tiles.clone()));
        surfaces.push(Surface::quad([c, d, e, f], [12, 8], tiles.clone()));
        surfaces.push(Surface::facet([b, c, f], 8, plaster.clone()));
        surfaces.push(Surface::facet([d, a, e], 8, plaster.clone()));
    }
    Object::baked("houses", surfaces)
}

/// Lit windows of the houses.
pub fn windows() -> Object {
    let shader: SkinShader = Arc::new(|place: &Place| Skin::matt(place, Vec3::ZERO));
    let mut surfaces = Vec::new();
    for (k, house) in row_of_houses().iter().enumerate() {
        let turn = glam::Quat::from_rotation_y(house.yaw);
        for row in 0..3 {
            for column in 0..3 {
                let lit = hash(k as i32, row, column) < 0.42;
                let y = 0.16 + 0.18 * row as f32;
                if !lit || y + 0.1 > house.half.y {
                    continue;
                }
                let x = (column as f32 - 1.0) * house.half.x * 0.6;
                let at = |dx: f32, dy: f32| {
                    house.base + turn * Vec3::new(x + dx * 0.026, y + dy * 0.042, house.half.z + 0.004)
                };
                surfaces.push(Surface::quad(
                    [at(-1., -1.), at(1., -1.), at(1., 1.), at(-1., 1.)],
                    [4, 4],
                    shader.clone(),
                ));
            }
        }
    }
    Object { name: "windows", surfaces, shine: Shine::Emitter(Vec3::new(1.0, 0.60, 0.22), 4.5) }
}

/// Hills against the sky.
pub fn hills() -> Object {
    let shader: SkinShader = Arc::new(|place: &Place| {
        let haze = Vec3::new(0.045, 0.060, 0.110)
            .lerp(Vec3::new(0.16, 0.10, 0.12), (place.uv.x - 0.25).clamp(0.0, 1.0) * 0.7);
        Skin { glow: haze, ..Skin::matt(place, Vec3::ZERO) }
    });
    let surface = Surface::grid(40, 3, [80, 4], shader, |u, v| {
        let x = -4.3 + 8.6 * u;
        let crest =
            0.40 + 0.40 * noise(Vec3::new(u * 4.0, 3.3, 0.0)) + 0.12 * noise(Vec3::new(u * 17.0, 1.0, 0.0));
        Vec3::new(x, 0.2 + (crest - 0.2) * v, -7.75)
    });
    Object::baked("hills", vec![surface])
}

/// The sky behind it all, a curved sheet.
pub fn backdrop(view: &View) -> Object {
    let eye = view.eye;
    let shader: SkinShader = Arc::new(move |place: &Place| {
        let direction = (place.position - eye).normalize();
        let streak = rough(Vec3::new(direction.x * 4.0, direction.y * 26.0, 2.0));
        let cloud = Vec3::new(0.30, 0.13, 0.13)
            * ((streak - 0.48).max(0.0) * 2.2)
            * (1.0 - direction.y * 1.8).clamp(0.0, 1.0);
        Skin { glow: sky(direction) + cloud, ..Skin::matt(place, Vec3::ZERO) }
    });
    let surface = Surface::grid(25, 9, [150, 64], shader, |u, v| {
        let angle = (u - 0.5) * 1.12;
        Vec3::new(8.0 * angle.sin(), 0.25 + 1.95 * v, -8.0 * angle.cos())
    });
    Object::baked("sky", vec![surface])
}
