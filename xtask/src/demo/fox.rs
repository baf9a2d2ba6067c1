//! The fox: folded from a sheet of orange paper, sitting, its eyes closed. Lengths in centimetres until placed.

use super::noise::{noise, smoothstep};
use super::surface::{Object, Place, Skin, SkinShader, Surface};
use glam::{Quat, Vec3};
use std::sync::Arc;

const ORANGE: Vec3 = Vec3::new(0.86, 0.235, 0.035);
const AMBER: Vec3 = Vec3::new(0.93, 0.33, 0.055);
const CREAM: Vec3 = Vec3::new(0.90, 0.83, 0.70);
const UMBER: Vec3 = Vec3::new(0.070, 0.030, 0.020);

/// The fox, its feet at `base`, looking `yaw` away from +z toward +x.
pub fn fox(base: Vec3, yaw: f32, size: f32) -> Object {
    let mut folds = Folds::default();
    head(&mut folds);
    // It has turned its head toward us.
    let glance = Quat::from_rotation_y(-0.48) * Quat::from_rotation_z(0.06);
    let neck = Vec3::new(0.0, 11.0, -0.4);
    for (corners, _) in &mut folds.facets {
        *corners = corners.map(|p| neck + glance * (p - neck));
    }
    body(&mut folds);
    tail(&mut folds);
    let turn = Quat::from_rotation_y(yaw);
    let surfaces = folds.facets.into_iter().map(|(corners, color)| {
        let corners = corners.map(|p| base + turn * (p * 0.01 * size));
        let longest = (corners[0] - corners[1]).length().max((corners[0] - corners[2]).length()) / size;
        let texels = ((longest * 560.0) as usize).clamp(8, 56);
        Surface::facet(corners, texels, paper(color))
    });
    Object::baked("fox", surfaces.collect())
}

/// Paper: a faint grain, and folds that catch the light.
fn paper(color: Vec3) -> SkinShader {
    Arc::new(move |place: &Place| {
        let grain = 0.94 + 0.12 * noise(place.position * 900.0);
        let edge = place.uv.x.min(place.uv.y).min(1.0 - place.uv.x - place.uv.y);
        let fold = 1.0 + 0.22 * (1.0 - smoothstep(0.0, 0.05, edge));
        Skin::matt(place, (color * grain * fold).min(Vec3::splat(0.95)))
    })
}

#[derive(Default)]
struct Folds {
    facets: Vec<([Vec3; 3], Vec3)>,
}

impl Folds {
    /// A facet that faces away from `inside`.
    fn add(&mut self, inside: Vec3, corners: [Vec3; 3], color: Vec3) {
        let [a, b, c] = corners;
        let outward = (b - a).cross(c - a).dot((a + b + c) / 3.0 - inside) >= 0.0;
        self.facets.push((if outward { corners } else { [a, c, b] }, color));
    }

    /// A facet and its mirror image.
    fn pair(&mut self, inside: Vec3, corners: [[f32; 3]; 3], color: Vec3) {
        let right = corners.map(Vec3::from);
        let mirrored = |p: Vec3| Vec3::new(-p.x, p.y, p.z);
        self.add(inside, right, color);
        self.add(mirrored(inside), right.map(mirrored), color);
    }

    /// A dark patch laid on a facet and its mirror image: corners as weights of the facet's.
    fn patch(&mut self, inside: Vec3, corners: [[f32; 3]; 3], weights: [[f32; 3]; 3]) {
        let [a, b, c] = corners.map(Vec3::from);
        let normal = (b - a).cross(c - a).normalize();
        let normal = normal * normal.dot(a - inside).signum();
        let laid = weights.map(|w| (a * w[0] + b * w[1] + c * w[2] + normal * 0.07).to_array());
        self.pair(inside, laid, UMBER);
    }
}

fn head(folds: &mut Folds) {
    let inside = Vec3::new(0.0, 13.4, -0.4);
    let nose = [0.0, 12.0, 5.6];
    let brow = [0.0, 15.0, 2.0];
    let crown = [0.0, 16.2, -0.8];
    let nape = [0.0, 12.6, -3.6];
    let cheek = [5.0, 12.4, 0.0];
    let jaw = [2.1, 10.5, 1.5];
    let chin = [0.0, 10.9, 3.2];
    let snout = [1.35, 12.5, 2.9];
    let temple = [2.7, 14.6, 1.0];
    let ear_in = [0.9, 16.0, 0.0];
    let ear_out = [4.0, 14.6, -0.6];
    let ear_back = [2.2, 15.0, -2.2];
    let ear_tip = [3.9, 19.4, -0.9];

    folds.pair(inside, [nose, snout, brow], AMBER);
    folds.pair(inside, [brow, snout, temple], ORANGE);
    folds.pair(inside, [snout, cheek, temple], ORANGE);
    folds.pair(inside, [brow, temple, ear_in], AMBER);
    folds.pair(inside, [brow, ear_in, crown], AMBER);
    folds.pair(inside, [temple, ear_out, ear_in], ORANGE);
    folds.pair(inside, [temple, cheek, ear_out], ORANGE);
    folds.pair(inside, [snout, jaw, cheek], CREAM);
    folds.pair(inside, [nose, jaw, snout], CREAM);
    folds.pair(inside, [nose, chin, jaw], CREAM);
    folds.pair(inside, [ear_out, cheek, nape], ORANGE);
    folds.pair(inside, [ear_out, nape, ear_back], ORANGE);
    folds.pair(inside, [ear_back, nape, crown], AMBER);
    folds.pair(inside, [ear_in, ear_back, crown], AMBER);
    folds.pair(inside, [cheek, jaw, nape], CREAM);
    folds.pair(inside, [jaw, chin, nape], CREAM);

    let in_ear = Vec3::new(2.5, 16.4, -1.1);
    folds.pair(in_ear, [ear_in, ear_out, ear_tip], ORANGE);
    folds.pair(in_ear, [ear_in, ear_tip, ear_back], AMBER);
    folds.pair(in_ear, [ear_out, ear_back, ear_tip], UMBER);
    folds.patch(
        in_ear,
        [ear_in, ear_out, ear_tip],
        [[0.70, 0.16, 0.14], [0.18, 0.68, 0.14], [0.17, 0.17, 0.66]],
    );

    // Closed eyes: two long lids on the facets beside the snout.
    let (inner, outer) = ([0.53, 0.04, 0.43], [0.10, 0.44, 0.46]);
    let (upper, lower) = ([0.38, 0.28, 0.34], [0.43, 0.33, 0.24]);
    folds.patch(inside, [snout, cheek, temple], [inner, lower, upper]);
    folds.patch(inside, [snout, cheek, temple], [outer, upper, lower]);
    for facet in [[nose, snout, brow], [nose, jaw, snout], [nose, chin, jaw]] {
        folds.patch(inside, facet, [[1.0, 0.0, 0.0], [0.66, 0.34, 0.0], [0.76, 0.0, 0.24]]);
    }
}

fn body(folds: &mut Folds) {
    let inside = Vec3::new(0.0, 4.6, -2.0);
    let neck = [1.9, 10.6, 0.8];
    let throat = [0.0, 10.6, 1.4];
    let chest = [0.0, 7.2, 3.9];
    let chest_low = [0.0, 3.0, 3.3];
    let shoulder = [3.1, 8.0, 0.4];
    let elbow = [3.2, 3.6, 1.4];
    let withers = [0.0, 10.8, -2.6];
    let back = [0.0, 7.0, -5.4];
    let rump = [0.0, 2.2, -7.4];
    let haunch = [4.6, 4.2, -3.4];
    let hind_foot = [4.3, 0.0, -0.8];
    let hind_back = [2.8, 0.0, -6.8];
    let toe = [1.5, 0.0, 4.3];
    let heel = [2.9, 0.0, 2.6];

    folds.pair(inside, [neck, shoulder, chest], CREAM);
    folds.pair(inside, [throat, neck, chest], CREAM);
    folds.pair(inside, [throat, neck, withers], CREAM);
    folds.pair(inside, [chest, shoulder, elbow], ORANGE);
    folds.pair(inside, [chest, elbow, chest_low], CREAM);
    folds.pair(inside, [chest_low, elbow, toe], AMBER);
    folds.pair(inside, [elbow, heel, toe], UMBER);
    folds.pair(inside, [neck, withers, shoulder], ORANGE);
    folds.pair(inside, [shoulder, withers, haunch], AMBER);
    folds.pair(inside, [shoulder, haunch, elbow], ORANGE);
    folds.pair(inside, [withers, back, haunch], ORANGE);
    folds.pair(inside, [back, rump, haunch], AMBER);
    folds.pair(inside, [elbow, haunch, hind_foot], AMBER);
    folds.pair(inside, [elbow, hind_foot, heel], ORANGE);
    folds.pair(inside, [haunch, hind_back, hind_foot], ORANGE);
    folds.pair(inside, [haunch, rump, hind_back], ORANGE);
}

/// The tail sweeps around to the fox's right and lies beside it: a folded strip of diamond section.
fn tail(folds: &mut Folds) {
    let spine = [[-0.5, 1.8, -7.0], [-5.2, 2.2, -7.6], [-8.4, 2.7, -4.2], [-8.3, 2.6, 0.2], [-5.4, 1.6, 4.6]]
        .map(Vec3::from);
    let half_width = [0.7, 1.9, 2.4, 2.1, 0.0];
    let ring = |k: usize| {
        let along = spine[(k + 1).min(4)] - spine[k.saturating_sub(1)];
        let side = along.cross(Vec3::Y).normalize() * half_width[k];
        let up = Vec3::Y * half_width[k];
        [spine[k] + up, spine[k] + side, spine[k] - up, spine[k] - side]
            .map(|p| p.max(Vec3::new(f32::MIN, 0.0, f32::MIN)))
    };
    for k in 0..4 {
        let (from, to) = (ring(k), ring(k + 1));
        let inside = (spine[k] + spine[k + 1]) / 2.0;
        let (first, second) = if k < 3 { (ORANGE, AMBER) } else { (CREAM, CREAM) };
        for side in 0..4 {
            let next = (side + 1) % 4;
            if from[side] != from[next] {
                folds.add(inside, [from[side], from[next], to[next]], first);
            }
            if k < 3 {
                folds.add(inside, [from[side], to[next], to[side]], second);
            }
        }
    }
}
