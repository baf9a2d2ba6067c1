//! Close to the lens: a border fence of bent iron hoops, and ivy that climbs it. Far out of focus, it turns to a veil.

use super::noise::{hash, noise};
use super::solids::tube;
use super::surface::{Object, Place, Skin, SkinShader, Surface};
use super::view::View;
use glam::{Quat, Vec3};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// Height of the hoops.
pub const HEIGHT: f32 = 0.150;

/// A point of the fence: `along` from left to right in metres, at a height. It comes nearer to the right.
pub fn point(along: f32, height: f32) -> Vec3 {
    Vec3::new(along, height, -(0.440 - 0.16 * along))
}

/// The hoops and the wires that hold them.
pub fn fence() -> Object {
    let shader: SkinShader = Arc::new(|place: &Place| {
        let rust = noise(place.position * 160.0);
        let albedo = Vec3::new(0.020, 0.023, 0.027).lerp(Vec3::new(0.055, 0.028, 0.016), rust * rust);
        Skin { wetness: 0.35, ..Skin::matt(place, albedo) }
    });
    let mut surfaces = Vec::new();
    let half = 0.046;
    for k in -5..=5 {
        let middle = k as f32 * 0.064 + 0.010;
        let shoulder = HEIGHT - half;
        let mut path = vec![point(middle - half, -0.01)];
        path.extend((0..=14).map(|i| {
            let angle = PI * (1.0 - i as f32 / 14.0);
            point(middle + half * angle.cos(), shoulder + half * angle.sin())
        }));
        path.push(point(middle + half, -0.01));
        surfaces.push(tube(&path, 0.0042, 8, [8, 40], shader.clone()));
    }
    for height in [0.035, 0.088] {
        let path: Vec<Vec3> = (0..=10).map(|i| point(-0.40 + 0.08 * i as f32, height)).collect();
        surfaces.push(tube(&path, 0.0024, 6, [6, 40], shader.clone()));
    }
    Object::baked("fence", surfaces)
}

/// Ivy on the fence, and a twig that hangs into the picture from above.
pub fn ivy(view: &View) -> Object {
    let mut surfaces = Vec::new();
    let stem = |points: &[Vec3], surfaces: &mut Vec<Surface>| {
        surfaces.push(tube(points, 0.0013, 5, [5, 24], super::surface::plain(Vec3::new(0.07, 0.05, 0.03))));
    };
    // Along the fence, denser to the left.
    for (strand, (from, to)) in [(-0.34f32, -0.11f32), (0.155, 0.33)].into_iter().enumerate() {
        let climb = |t: f32| {
            let along = from + (to - from) * t;
            let height = 0.075 + 0.062 * (t * 7.0 + strand as f32 * 2.0).sin() * (0.6 + 0.4 * t);
            point(along, height.max(0.01)) + Vec3::new(0.0, 0.0, 0.006 * (t * 23.0).cos())
        };
        let points: Vec<Vec3> = (0..=24).map(|k| climb(k as f32 / 24.0)).collect();
        stem(&points, &mut surfaces);
        let leaves = if strand == 0 { 22 } else { 13 };
        for k in 0..leaves {
            let t = (k as f32 + 0.5) / leaves as f32;
            let id = strand as i32 * 100 + k;
            let tip = Vec3::new(hash(id, 1, 0) - 0.5, hash(id, 2, 0) - 0.25, 0.6).normalize();
            surfaces.push(leaf(climb(t), tip, 0.020 + 0.012 * hash(id, 3, 0), id));
        }
    }
    // From above, at the left.
    let twig =
        |t: f32| view.at(-1.95 + 1.05 * t, 1.12 - 0.42 * t * t - 0.05 * (t * 9.0).sin(), 0.37 + 0.05 * t);
    let points: Vec<Vec3> = (0..=16).map(|k| twig(k as f32 / 16.0)).collect();
    stem(&points, &mut surfaces);
    for k in 0..11 {
        let t = (k as f32 + 0.5) / 11.0;
        let id = 900 + k;
        let tip =
            Vec3::new(hash(id, 1, 0) - 0.3, -0.4 - 0.6 * hash(id, 2, 0), hash(id, 3, 0) - 0.2).normalize();
        surfaces.push(leaf(twig(t), tip, 0.026 + 0.014 * hash(id, 4, 0), id));
    }
    Object::baked("ivy", surfaces)
}

/// A pointed leaf from its stalk toward `tip`, folded a little along its rib.
fn leaf(stalk: Vec3, tip: Vec3, length: f32, id: i32) -> Surface {
    let side = tip.cross(Quat::from_rotation_y(hash(id, 5, 0) * TAU) * Vec3::Z).normalize_or(Vec3::X);
    let up = side.cross(tip);
    let tint = Vec3::new(0.055, 0.150, 0.045).lerp(Vec3::new(0.140, 0.150, 0.030), hash(id, 6, 0));
    let shader: SkinShader = Arc::new(move |place: &Place| {
        let rib = (place.uv.x - 0.5).abs();
        let color = if rib < 0.05 { tint * 1.6 } else { tint * (0.8 + 0.4 * noise(place.position * 300.0)) };
        Skin { translucency: 0.22, wetness: 0.10, ..Skin::matt(place, color) }
    });
    Surface::grid(5, 7, [7, 12], shader, |u, v| {
        let across = (u - 0.5) * 2.0;
        let width = 0.42 * (PI * v.powf(0.75)).sin().max(0.0) * (1.0 - 0.25 * v) + 0.01;
        let droop = -0.25 * v * v + 0.16 * across.abs() * width;
        stalk + (tip * v + side * (across * width) + up * droop) * length
    })
    .thin()
}
