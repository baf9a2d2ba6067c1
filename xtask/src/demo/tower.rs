//! Far away: the clock tower, lit from below.

use super::noise::{hash, noise, smoothstep};
use super::solids::block;
use super::surface::{Object, Place, Skin, SkinShader, Surface};
use glam::{Quat, Vec2, Vec3};
use std::f32::consts::TAU;
use std::sync::Arc;

/// Half the width of the shaft.
pub const HALF_WIDTH: f32 = 0.29;
/// How far it is turned.
const YAW: f32 = -0.42;
/// Height of the clock's middle.
const CLOCK: f32 = 0.642;

/// Everything but the clock's face.
pub fn tower(base: Vec3) -> Object {
    let up = |height: f32| base + Vec3::Y * height;
    let w = HALF_WIDTH;
    let mut surfaces = block(up(-0.05), Vec3::new(w, 0.46, w), YAW, [150, 112], &masonry(base));
    let trim = stone();
    let ledges = [(0.395, 1.10, 0.030), (0.860, 1.12, 0.025), (0.885, 1.20, 0.025), (1.085, 0.90, 0.022)];
    for (height, half, thick) in ledges {
        surfaces.extend(block(up(height), Vec3::new(w * half, thick, w * half), YAW, [64, 6], &trim));
    }
    surfaces.extend(block(up(0.425), Vec3::new(w * 0.98, 0.435, w * 0.98), YAW, [140, 108], &masonry(base)));
    surfaces.extend(block(up(0.91), Vec3::new(w * 0.78, 0.175, w * 0.78), YAW, [110, 46], &belfry()));
    surfaces.extend(roof(up(1.107), w * 0.95, 0.27));
    surfaces.extend(block(up(1.36), Vec3::new(0.008, 0.075, 0.008), YAW, [4, 8], &trim));
    // Corner piers.
    let turn = Quat::from_rotation_y(YAW);
    for (x, z) in [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
        let corner = turn * Vec3::new(x * w * 0.97, 0.0, z * w * 0.97);
        surfaces.extend(block(up(-0.05) + corner, Vec3::new(0.040, 0.91, 0.040), YAW, [10, 96], &trim));
    }
    surfaces.push(disc(base, 0.205, 0.020, [64, 64], stone()));
    Object::baked("tower", surfaces)
}

/// The clock's face.
pub fn clock(base: Vec3) -> Object {
    let shader: SkinShader = Arc::new(|place: &Place| {
        let p = (place.uv - 0.5) * 2.0;
        let radius = p.length();
        // Clockwise from twelve, in turns.
        let turn = p.x.atan2(p.y) / TAU;
        let glass = Vec3::new(1.0, 0.86, 0.56) * (1.04 - 0.28 * radius * radius);
        let ring = band(radius, 0.94, 0.035).max(band(radius, 0.66, 0.012));
        let hour = |turns: f32| ((turns * 12.0 + 0.5).rem_euclid(1.0) - 0.5).abs() / 12.0 * TAU * radius;
        let quarter = ((turn * 4.0 + 0.5).rem_euclid(1.0) - 0.5).abs() < 0.1;
        let width = if quarter { 0.045 } else { 0.022 };
        let mark = (1.0 - smoothstep(width * 0.6, width * 1.3, hour(turn)))
            * smoothstep(0.68, 0.70, radius)
            * (1.0 - smoothstep(0.88, 0.90, radius));
        let hands = hand(p, 10.15 / 12.0, 0.46, 0.060)
            .max(hand(p, 0.15, 0.78, 0.040))
            .max(1.0 - smoothstep(0.06, 0.08, radius));
        let ink = ring.max(mark).max(hands);
        let glow = glass.lerp(Vec3::new(0.035, 0.025, 0.025), ink);
        Skin { glow, ..Skin::matt(place, Vec3::splat(0.05)) }
    });
    Object::baked("clock", vec![disc(base, 0.188, 0.030, [112, 112], shader)])
}

fn band(x: f32, middle: f32, half_width: f32) -> f32 {
    1.0 - smoothstep(half_width * 0.7, half_width * 1.3, (x - middle).abs())
}

fn hand(p: Vec2, turns: f32, length: f32, half_width: f32) -> f32 {
    let (sin, cos) = (turns * TAU).sin_cos();
    let along = p.x * sin + p.y * cos;
    let across = (p.x * cos - p.y * sin).abs();
    let taper = half_width * (1.0 - 0.6 * (along / length).clamp(0.0, 1.0));
    (1.0 - smoothstep(taper * 0.7, taper * 1.3, across))
        * smoothstep(-0.14, -0.10, along)
        * (1.0 - smoothstep(length - 0.04, length, along))
}

/// An upright disc on the tower's front, `proud` of the wall. Mapped as the square around it.
fn disc(base: Vec3, radius: f32, proud: f32, texels: [usize; 2], shader: SkinShader) -> Surface {
    let turn = Quat::from_rotation_y(YAW);
    let center = base + Vec3::Y * CLOCK + turn * Vec3::Z * (HALF_WIDTH * 0.98 + proud);
    // A square grid bent to a disc.
    Surface::grid(17, 17, texels, round(shader), |u, v| {
        let p = to_disc(Vec2::new(u, v) * 2.0 - 1.0) * radius;
        center + turn * p.extend(0.0)
    })
}

/// Applies a shader defined on a square to the grid that [`to_disc`] bends.
fn round(shader: SkinShader) -> SkinShader {
    Arc::new(move |place: &Place| shader(&Place { uv: to_disc(place.uv * 2.0 - 1.0) * 0.5 + 0.5, ..*place }))
}

fn to_disc(p: Vec2) -> Vec2 {
    Vec2::new(p.x * (1.0 - p.y * p.y / 2.0).sqrt(), p.y * (1.0 - p.x * p.x / 2.0).sqrt())
}

fn roof(base: Vec3, half: f32, height: f32) -> Vec<Surface> {
    let turn = Quat::from_rotation_y(YAW);
    let corner = |x: f32, z: f32| base + turn * Vec3::new(x * half, 0.0, z * half);
    let top = base + Vec3::Y * height;
    let slate: SkinShader = Arc::new(|place: &Place| {
        let course = (place.position.y * 42.0).floor();
        let tile = hash(course as i32, (place.position.x * 30.0 + course * 0.5).floor() as i32, 3);
        let line = smoothstep(0.0, 0.25, (place.position.y * 42.0).fract());
        Skin {
            wetness: 0.4,
            ..Skin::matt(place, Vec3::new(0.07, 0.10, 0.14) * (0.6 + 0.8 * tile) * (0.35 + 0.65 * line))
        }
    });
    let corners = [corner(-1., 1.), corner(1., 1.), corner(1., -1.), corner(-1., -1.)];
    (0..4).map(|k| Surface::facet([corners[k], corners[(k + 1) % 4], top], 88, slate.clone())).collect()
}

/// Coursed stone, with narrow windows that are lit.
fn masonry(base: Vec3) -> SkinShader {
    Arc::new(move |place: &Place| {
        let height = place.position.y - base.y;
        let course = (height / 0.052).floor();
        let turn = Quat::from_rotation_y(-YAW);
        let (turned, facing) = (turn * (place.position - base), turn * place.normal);
        let along = if facing.z.abs() > facing.x.abs() { turned.x } else { turned.z };
        let cell = (along / 0.095 + 0.5 * course.rem_euclid(2.0)).floor();
        let joint_y = ((height / 0.052).fract() - 0.5).abs();
        let joint_x = ((along / 0.095 + 0.5 * course.rem_euclid(2.0)).fract() - 0.5).abs();
        let joint = smoothstep(0.42, 0.48, joint_y).max(smoothstep(0.45, 0.48, joint_x));
        let tone = 0.75 + 0.5 * hash(cell as i32, course as i32, 6);
        let grain = 0.8 + 0.4 * noise(place.position * 60.0);
        let albedo = Vec3::new(0.40, 0.34, 0.27) * tone * grain * (1.0 - 0.55 * joint);
        let window = arch(Vec2::new(along, height - 0.17), 0.036, 0.13);
        let glow = Vec3::new(0.95, 0.58, 0.20) * window * 0.9;
        Skin { glow, ..Skin::matt(place, albedo * (1.0 - window)) }
    })
}

/// The open storey of the bells: arches, warm inside.
fn belfry() -> SkinShader {
    let stone = stone();
    Arc::new(move |place: &Place| {
        let across = (place.uv.x * 3.0).fract() - 0.5;
        let side = place.normal.y.abs() < 0.5;
        let opening = if side { arch(Vec2::new(across, place.uv.y - 0.12), 0.30, 0.72) } else { 0.0 };
        let mut skin = stone(place);
        skin.albedo *= 1.0 - opening;
        skin.glow = Vec3::new(0.80, 0.36, 0.10) * opening * (1.0 - 0.65 * place.uv.y);
        skin
    })
}

/// 1 within a round-topped opening whose sill's middle is the origin.
fn arch(p: Vec2, half_width: f32, height: f32) -> f32 {
    let spring = height - half_width;
    let edge = if p.y < spring {
        p.x.abs() - half_width
    } else {
        (p - Vec2::new(0.0, spring)).length() - half_width
    };
    (1.0 - smoothstep(-0.08 * half_width, 0.08 * half_width, edge)) * smoothstep(-0.004, 0.004, p.y)
}

fn stone() -> SkinShader {
    Arc::new(|place: &Place| {
        Skin::matt(place, Vec3::new(0.46, 0.40, 0.33) * (0.8 + 0.4 * noise(place.position * 45.0)))
    })
}
