//! Common solids as surfaces: tubes, turned shapes, spheres, boxes.

use super::surface::{SkinShader, Surface};
use glam::Vec3;
use std::f32::consts::TAU;

/// A tube of constant radius along a polyline.
pub fn tube(path: &[Vec3], radius: f32, sides: usize, texels: [usize; 2], shader: SkinShader) -> Surface {
    tapered(path, |_| radius, sides, texels, shader)
}

/// A tube along a polyline whose radius depends on how far along it is, 0 to 1.
pub fn tapered(
    path: &[Vec3],
    radius: impl Fn(f32) -> f32,
    sides: usize,
    texels: [usize; 2],
    shader: SkinShader,
) -> Surface {
    let last = path.len() - 1;
    let direction = |k: usize| (path[(k + 1).min(last)] - path[k.saturating_sub(1)]).normalize_or(Vec3::Y);
    // The frame is carried along so that the tube does not twist.
    let mut side = direction(0).any_orthonormal_vector();
    let mut frames = Vec::with_capacity(path.len());
    for k in 0..path.len() {
        let along = direction(k);
        side = (side - along * side.dot(along)).normalize_or(along.any_orthonormal_vector());
        frames.push((side, along.cross(side)));
    }
    Surface::grid(sides + 1, path.len(), texels, shader, |u, v| {
        let k = (v * last as f32).round() as usize;
        let (a, b) = frames[k];
        let angle = u * TAU;
        path[k] + (a * angle.cos() + b * angle.sin()) * radius(v)
    })
}

/// A shape turned about a vertical axis through `base`: `profile` gives (radius, height) from bottom to top.
pub fn turned(
    base: Vec3,
    profile: &[(f32, f32)],
    sides: usize,
    texels: [usize; 2],
    shader: SkinShader,
) -> Surface {
    let last = profile.len() - 1;
    Surface::grid(sides + 1, profile.len(), texels, shader, |u, v| {
        let (radius, height) = profile[(v * last as f32).round() as usize];
        let angle = -u * TAU;
        base + Vec3::new(angle.cos() * radius, height, angle.sin() * radius)
    })
}

/// A sphere.
pub fn sphere(center: Vec3, radius: f32, sides: usize, texels: [usize; 2], shader: SkinShader) -> Surface {
    ball(center, sides, texels, shader, |_| radius)
}

/// A ball whose radius depends on the direction.
pub fn ball(
    center: Vec3,
    sides: usize,
    texels: [usize; 2],
    shader: SkinShader,
    radius: impl Fn(Vec3) -> f32,
) -> Surface {
    Surface::grid(sides + 1, sides / 2 + 1, texels, shader, |u, v| {
        let (angle, height) = (-u * TAU, (v - 0.5) * TAU / 2.0);
        let around = if v == 0.0 || v == 1.0 { 0.0 } else { height.cos() };
        let direction = Vec3::new(angle.cos() * around, height.sin(), angle.sin() * around);
        center + direction * radius(direction)
    })
}

/// An upright box turned about its axis by `yaw`: centre of its base, half width, height, half depth. All sides but
/// the bottom.
pub fn block(base: Vec3, half: Vec3, yaw: f32, texels: [usize; 2], shader: &SkinShader) -> Vec<Surface> {
    let turn = glam::Quat::from_rotation_y(yaw);
    let corner = |x: f32, y: f32, z: f32| base + turn * Vec3::new(x * half.x, y * half.y, z * half.z);
    let quad = |corners, texels| Surface::quad(corners, texels, shader.clone());
    let c = corner;
    vec![
        quad([c(-1., 0., 1.), c(1., 0., 1.), c(1., 1., 1.), c(-1., 1., 1.)], texels),
        quad([c(1., 0., 1.), c(1., 0., -1.), c(1., 1., -1.), c(1., 1., 1.)], texels),
        quad([c(1., 0., -1.), c(-1., 0., -1.), c(-1., 1., -1.), c(1., 1., -1.)], texels),
        quad([c(-1., 0., -1.), c(-1., 0., 1.), c(-1., 1., 1.), c(-1., 1., -1.)], texels),
        quad([c(-1., 1., 1.), c(1., 1., 1.), c(1., 1., -1.), c(-1., 1., -1.)], texels.map(|n| n.min(12))),
    ]
}
