//! The butterfly on the fence: four wings of blue that seem to shine.

use super::noise::{noise, smoothstep};
use super::solids::tapered;
use super::surface::{Object, Place, Skin, SkinShader, Surface, plain};
use glam::{EulerRot, Quat, Vec3};
use std::sync::Arc;

/// The butterfly, its body's middle at `center`, a wing `span` long.
pub fn butterfly(center: Vec3, span: f32) -> Object {
    let turn = Quat::from_euler(EulerRot::YXZ, 0.30, -0.25, -0.42);
    let place = |p: Vec3| center + turn * (p * span);
    let mut surfaces = Vec::new();
    for side in [1.0f32, -1.0] {
        for hind in [false, true] {
            let fold = Quat::from_rotation_y(-side * if hind { 0.42 } else { 0.30 });
            let wing = Surface::grid(9, 15, [72, 96], scales(hind), |u, v| {
                let (angle, reach) = if hind { hind_wing(v) } else { fore_wing(v) };
                let (sin, cos) = angle.sin_cos();
                let radius = 0.035 + (reach - 0.035) * u;
                let camber = 0.05 * (u * 3.0).sin();
                let flat = Vec3::new(
                    side * cos * radius,
                    sin * radius,
                    camber * 0.4 - if hind { 0.012 } else { 0.0 },
                );
                place(fold * flat)
            });
            surfaces.push(wing.thin());
        }
        let feeler: Vec<Vec3> = (0..8)
            .map(|k| {
                let t = k as f32 / 7.0;
                place(Vec3::new(
                    side * (0.02 + 0.20 * t),
                    0.20 + 0.34 * t - 0.04 * t * t,
                    0.03 + 0.10 * t * t,
                ))
            })
            .collect();
        surfaces.push(tapered(
            &feeler,
            |t| span * (0.006 + 0.010 * smoothstep(0.85, 1.0, t)),
            5,
            [3, 10],
            plain(Vec3::splat(0.02)),
        ));
    }
    let body: Vec<Vec3> =
        (0..12).map(|k| place(Vec3::new(0.0, -0.42 + 0.66 * k as f32 / 11.0, 0.02))).collect();
    let thickness =
        move |t: f32| span * (0.012 + 0.045 * (t * std::f32::consts::PI).sin().max(0.0).powf(0.7));
    surfaces.push(tapered(&body, thickness, 8, [10, 24], plain(Vec3::new(0.035, 0.035, 0.05))));
    Object::baked("butterfly", surfaces)
}

/// Angle above the horizontal and reach of the fore wing's outline.
fn fore_wing(v: f32) -> (f32, f32) {
    let angle = 1.12 - 1.10 * v;
    (angle, 0.60 + 0.44 * (-((v - 0.20) / 0.34).powi(2)).exp() + 0.05 * v)
}

/// The same of the hind wing, which ends in a short tail.
fn hind_wing(v: f32) -> (f32, f32) {
    let angle = 0.06 - 1.38 * v;
    let scallop = 0.018 * (v * 28.0).cos();
    let tail = 0.15 * (-((v - 0.66) / 0.07).powi(2)).exp();
    (angle, 0.62 + 0.10 * (v * 2.6).sin() - 0.08 * v + scallop + tail)
}

fn scales(hind: bool) -> SkinShader {
    Arc::new(move |place: &Place| {
        let (u, v) = (place.uv.x, place.uv.y);
        let wave = 0.5 + 0.5 * (v * 5.0 + u * 3.0).sin();
        let blue =
            Vec3::new(0.02, 0.16, 0.85).lerp(Vec3::new(0.05, 0.62, 0.95), wave * smoothstep(0.05, 0.8, u));
        let blue = blue.lerp(Vec3::new(0.22, 0.10, 0.75), (1.0 - smoothstep(0.0, 0.35, u)) * 0.6);
        let ribs = if hind { 6.0 } else { 7.0 };
        let rib = ((v * ribs).fract() - 0.5).abs();
        let vein = smoothstep(0.40, 0.5, rib) * smoothstep(0.15, 0.4, u) * 0.75;
        let margin = smoothstep(0.74, 0.84, u + 0.05 * (v * ribs * std::f32::consts::TAU).cos());
        let leading = if hind { 0.0 } else { 1.0 - smoothstep(0.02, 0.07, v) };
        let dark = vein.max(margin).max(leading);
        let dot = smoothstep(0.20, 0.12, (((v * ribs).fract() - 0.5) * 0.55).hypot((u - 0.905) * 2.6));
        let ink = Vec3::new(0.010, 0.010, 0.030);
        let dust = 0.9 + 0.2 * noise(place.position * 1500.0);
        let color = blue.lerp(ink, dark).lerp(Vec3::new(0.85, 0.92, 1.0), dot) * dust;
        Skin { glow: color * 0.42, translucency: 0.35, ..Skin::matt(place, color) }
    })
}
