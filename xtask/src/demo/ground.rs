//! The ground: a path of wet setts that winds away between beds of grass.

use super::noise::{hash, noise, rough, smoothstep};
use super::surface::{Object, Skin, Surface};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Nearest and farthest depth.
const DEPTHS: [f32; 2] = [0.2, 7.4];
/// Length and width of a sett.
const SETT: [f32; 2] = [0.105, 0.080];
/// How far the path reaches to either side of its middle.
const HALF_PATH: f32 = 0.44;

/// The middle of the path at a depth (the distance ahead of the camera).
pub fn path_middle(depth: f32) -> f32 {
    0.021 * depth * depth - 0.06
}

/// The ground.
pub fn ground() -> Object {
    let shader = Arc::new(|place: &super::surface::Place| {
        let (x, z) = (place.position.x, place.position.z);
        let step = 4e-4 * (-z).max(0.5);
        let slope =
            Vec2::new(height(x + step, z) - height(x - step, z), height(x, z + step) - height(x, z - step));
        let normal = Vec3::new(-slope.x, 2.0 * step, -slope.y).normalize();
        let (albedo, wetness) = color(x, z);
        let puddle = puddle(x, z);
        let normal = normal.lerp(Vec3::Y, puddle * 0.97).normalize();
        let wetness = wetness + (1.0 - wetness) * puddle;
        let ripple = 0.006 + (0.0004 - 0.006) * puddle;
        Skin { normal, wetness, ripple, ..Skin::matt(place, albedo * (1.0 - 0.55 * puddle)) }
    });
    let surface = Surface::grid(104, 124, [720, 512], shader, |u, v| {
        let depth = DEPTHS[0] * (DEPTHS[1] / DEPTHS[0]).powf(v);
        let half_width = 0.08 + 0.53 * depth;
        let x = (2.0 * u - 1.0) * half_width;
        Vec3::new(x, height(x, -depth), -depth)
    });
    Object::baked("ground", vec![surface])
}

/// A place in the pattern of setts.
struct Sett {
    /// Distance into the stone from its rounded outline; negative in the joint.
    inside: f32,
    /// From the stone's middle, in units of half its size.
    off_center: Vec2,
    /// Its own hash coordinates.
    id: [i32; 2],
}

fn sett(x: f32, z: f32) -> Sett {
    let warp =
        Vec2::new(noise(Vec3::new(x * 22.0, 0.0, z * 22.0)), noise(Vec3::new(x * 22.0, 9.0, z * 22.0))) - 0.5;
    let across = x - path_middle(-z) + warp.x * 0.010;
    let along = -z + warp.y * 0.010;
    let row = (along / SETT[1]).floor();
    let shift = 0.5 * (row as i32).rem_euclid(2) as f32 + 0.25 * hash(row as i32, 3, 5);
    let column = (across / SETT[0] + shift).floor();
    let local = Vec2::new(
        (across / SETT[0] + shift - column - 0.5) * SETT[0],
        (along / SETT[1] - row - 0.5) * SETT[1],
    );
    let half = Vec2::new(SETT[0], SETT[1]) / 2.0 - 0.0035;
    let radius = 0.020;
    let outside = local.abs() - (half - radius);
    let inside = radius - outside.max(Vec2::ZERO).length() - outside.max_element().min(0.0);
    Sett { inside, off_center: local / half, id: [column as i32, row as i32] }
}

/// 1 on the path, 0 in the beds.
fn on_path(x: f32, z: f32) -> f32 {
    let ragged = (noise(Vec3::new(x * 30.0, 2.0, z * 30.0)) - 0.5) * 0.05;
    1.0 - smoothstep(HALF_PATH - 0.02, HALF_PATH + 0.02, (x - path_middle(-z)).abs() + ragged)
}

/// Fine detail fades where a texel is larger than it.
fn detail(z: f32) -> f32 {
    1.0 - 0.85 * smoothstep(0.9, 2.6, -z)
}

fn height(x: f32, z: f32) -> f32 {
    let path = on_path(x, z);
    let stone = sett(x, z);
    let [i, j] = stone.id;
    let tilt = stone.off_center.dot(Vec2::new(hash(i, j, 1) - 0.5, hash(i, j, 2) - 0.5)) * 0.0035;
    let dome = smoothstep(-0.002, 0.020, stone.inside) * 0.0085 + (hash(i, j, 4) - 0.5) * 0.003;
    let grain = rough(Vec3::new(x, 0.0, z) * 160.0) * 0.0012 * detail(z);
    let grass =
        0.006 + 0.018 * rough(Vec3::new(x, 1.0, z) * 38.0) + 0.012 * noise(Vec3::new(x, 4.0, z) * 9.0);
    let paved = if stone.inside > -0.002 { dome + tilt + grain } else { grain * 0.3 };
    grass + (paved - grass) * path
}

/// 1 where rain water stands between the stones or over them.
fn puddle(x: f32, z: f32) -> f32 {
    let level = 0.0135 * smoothstep(0.36, 0.72, noise(Vec3::new(x * 2.9 + 0.4, 6.0, z * 2.3 + 0.9)));
    smoothstep(0.0, 0.0012, level - height(x, z)) * on_path(x, z)
}

fn color(x: f32, z: f32) -> (Vec3, f32) {
    let path = on_path(x, z);
    let stone = sett(x, z);
    let [i, j] = stone.id;
    let tone = 0.10 + 0.20 * hash(i, j, 7);
    let warm = hash(i, j, 8) - 0.5;
    let speckle = 1.0 + (rough(Vec3::new(x, 5.0, z) * 120.0) - 0.5) * 0.5 * detail(z);
    let face = Vec3::new(1.0 + 0.25 * warm, 1.0, 1.06 - 0.30 * warm) * tone * speckle;
    let joint = Vec3::new(0.030, 0.036, 0.022);
    let paved = joint.lerp(face, smoothstep(0.0, 0.006, stone.inside));
    let blade = 0.5 + (rough(Vec3::new(x * 90.0, 0.0, z * 45.0)) - 0.5) * detail(z);
    let grass = Vec3::new(0.06, 0.12, 0.035) * (0.35 + 1.3 * blade);
    (grass.lerp(paved, path), path * (0.35 + 0.65 * noise(Vec3::new(x * 5.0, 8.0, z * 3.0))))
}
