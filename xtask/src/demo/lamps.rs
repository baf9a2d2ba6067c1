//! What shines: lanterns along the path, strings of bulbs above it, and the lamps that light the scene by them.

use super::ground::path_middle;
use super::light::Lamp;
use super::noise::hash;
use super::solids::{block, sphere, tube, turned};
use super::surface::{Object, Place, Shine, Skin, SkinShader, Surface, plain};
use super::view::View;
use glam::Vec3;
use std::sync::Arc;

const CANDLE: Vec3 = Vec3::new(1.0, 0.58, 0.20);

/// Where a lantern stands: its foot, and how large it is.
fn lanterns() -> Vec<(Vec3, f32)> {
    // Depth, side of the path, size.
    [
        (1.28, -1.0, 1.0),
        (1.62, 1.32, 1.0),
        (2.3, -1.0, 1.1),
        (2.9, 1.0, 1.1),
        (3.8, -1.0, 1.2),
        (4.7, 1.0, 1.3),
        (5.8, -1.0, 1.4),
    ]
    .map(|(depth, side, size): (f32, f32, f32)| {
        (Vec3::new(path_middle(depth) + side * 0.43, 0.0, -depth), size)
    })
    .into()
}

/// Height of the flame over the foot of a lantern of size 1.
const FLAME: f32 = 0.118;

/// The lanterns' iron.
pub fn lantern_frames() -> Object {
    let iron: SkinShader =
        Arc::new(|place: &Place| Skin { wetness: 0.3, ..Skin::matt(place, Vec3::new(0.05, 0.05, 0.055)) });
    let mut surfaces = Vec::new();
    for (foot, size) in lanterns() {
        let up = |y: f32| foot + Vec3::Y * (y * size);
        surfaces.extend(block(up(0.0), Vec3::new(0.034, 0.02, 0.034) * size, 0.3, [8, 4], &iron));
        surfaces.extend(block(up(0.02), Vec3::new(0.014, 0.055, 0.014) * size, 0.3, [5, 8], &iron));
        surfaces.extend(block(up(0.075), Vec3::new(0.036, 0.008, 0.036) * size, 0.3, [10, 3], &iron));
        for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let corner = glam::Quat::from_rotation_y(0.3) * Vec3::new(x, 0.0, z) * 0.030 * size;
            surfaces.extend(block(
                up(0.083) + corner,
                Vec3::new(0.003, 0.072, 0.003) * size,
                0.3,
                [3, 10],
                &iron,
            ));
        }
        let cap =
            [(0.048, 0.155), (0.046, 0.160), (0.022, 0.185), (0.008, 0.198), (0.004, 0.212), (0.0, 0.214)];
        surfaces.push(turned(foot, &cap.map(|(r, y)| (r * size, y * size)), 10, [14, 10], iron.clone()));
    }
    Object::baked("lanterns", surfaces)
}

/// Their glowing glass.
pub fn lantern_glass() -> Object {
    let glass = |(foot, size): (Vec3, f32)| {
        let profile =
            [(0.0, 0.086), (0.018, 0.088), (0.022, 0.100), (0.022, 0.138), (0.016, 0.150), (0.0, 0.152)];
        turned(foot, &profile.map(|(r, y)| (r * size, y * size)), 12, [6, 4], plain(Vec3::ZERO))
    };
    Object {
        name: "lantern glass",
        surfaces: lanterns().into_iter().map(glass).collect(),
        shine: Shine::Emitter(CANDLE, 2.4),
    }
}

/// The strings: from, to and sag, as (x, y, depth) in the picture.
const STRINGS: [([f32; 3], [f32; 3], f32, usize); 4] = [
    ([-2.1, 1.00, 1.9], [0.62, 0.74, 6.1], 0.10, 12),
    ([1.00, 0.74, 6.1], [2.2, 1.00, 2.2], 0.05, 6),
    ([-2.2, 0.60, 3.0], [0.55, 0.42, 6.3], 0.10, 10),
    ([1.34, 0.40, 6.0], [2.2, 0.62, 3.0], 0.06, 5),
];

fn along_string(view: &View, string: usize, t: f32) -> Vec3 {
    let (from, to, sag, _) = STRINGS[string];
    let [a, b] = [from, to].map(|[x, y, depth]| view.at(x, y, depth));
    a.lerp(b, t) - Vec3::Y * (4.0 * t * (1.0 - t) * sag * a.distance(b) * 0.5)
}

/// The wires of the strings.
pub fn wires(view: &View) -> Object {
    let wire = |string: usize| {
        let path: Vec<Vec3> = (0..=20).map(|k| along_string(view, string, k as f32 / 20.0)).collect();
        tube(&path, 0.0018, 4, [4, 24], plain(Vec3::splat(0.02)))
    };
    Object::baked("wires", (0..STRINGS.len()).map(wire).collect())
}

/// The bulbs, by colour.
pub fn bulbs(view: &View) -> Vec<Object> {
    let colors = [
        ("bulbs amber", Vec3::new(1.0, 0.56, 0.18), 46.0),
        ("bulbs white", Vec3::new(1.0, 0.80, 0.52), 34.0),
        ("bulbs rose", Vec3::new(1.0, 0.34, 0.26), 40.0),
    ];
    let mut surfaces: [Vec<Surface>; 3] = Default::default();
    for (position, color) in bulb_places(view) {
        surfaces[color].push(sphere(position, 0.0075, 10, [3, 3], plain(Vec3::ZERO)));
    }
    let objects = colors.into_iter().zip(surfaces);
    objects
        .map(|((name, color, strength), surfaces)| Object {
            name,
            surfaces,
            shine: Shine::Emitter(color, strength),
        })
        .collect()
}

fn bulb_places(view: &View) -> Vec<(Vec3, usize)> {
    let mut places = Vec::new();
    for (string, (from, to, _, count)) in STRINGS.iter().enumerate() {
        for k in 0..*count {
            // Evenly in the picture, not in the world: far ones would crowd.
            let s = (k as f32 + 0.5) / *count as f32;
            let t = s * from[2] / ((1.0 - s) * to[2] + s * from[2]);
            let draw = hash(string as i32, k as i32, 9);
            let color = if draw < 0.55 {
                0
            } else if draw < 0.85 {
                1
            } else {
                2
            };
            places.push((along_string(view, string, t) - Vec3::Y * 0.014, color));
        }
    }
    // Bulbs in the nearer trees, on the side toward us.
    for (tree, (center, radius)) in super::garden::crowns().into_iter().take(5).enumerate() {
        for k in 0..7 {
            let draw = |n: i32| hash(tree as i32, k, n);
            let direction =
                Vec3::new(draw(20) * 2.0 - 1.0, draw(21) * 1.7 - 0.8, 0.35 + draw(22)).normalize();
            places.push((center + direction * radius * 1.08, if draw(23) < 0.7 { 0 } else { 1 }));
        }
    }
    places
}

/// The lamps that light the scene: the lanterns, every third bulb for its neighbours, a reading lamp out of the
/// picture for the fox, and what lights the tower.
pub fn lamps(view: &View, tower: Vec3) -> Vec<Lamp> {
    let mut lamps: Vec<Lamp> = lanterns()
        .into_iter()
        .map(|(foot, size)| Lamp {
            position: foot + Vec3::Y * FLAME * size,
            radius: 0.024 * size,
            intensity: CANDLE * 0.13 * size * size,
        })
        .collect();
    for (position, _) in bulb_places(view).into_iter().step_by(3) {
        lamps.push(Lamp { position, radius: 0.02, intensity: Vec3::new(1.0, 0.62, 0.28) * 0.22 });
    }
    lamps.push(Lamp {
        position: view.at(-1.5, 1.55, 0.40),
        radius: 0.04,
        intensity: Vec3::new(1.0, 0.74, 0.46) * 0.60,
    });
    lamps.push(Lamp {
        position: view.at(2.6, 0.9, 0.95),
        radius: 0.06,
        intensity: Vec3::new(0.35, 0.55, 1.0) * 0.40,
    });
    for x in [-0.28, 0.34] {
        lamps.push(Lamp {
            position: tower + Vec3::new(x, 0.06, 0.62),
            radius: 0.04,
            intensity: Vec3::new(1.0, 0.60, 0.26) * 0.85,
        });
    }
    lamps
}
