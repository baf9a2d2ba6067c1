//! A light field with exact truth: slanted planes, balls, thin rods and a flat grey card, by ray casting.
//!
//! The eye of view (u, v) is at (B u, B v, 0) and looks along +z; its sensor is shifted so that what is `IN_FOCUS` away stays where
//! it is. A point at depth z then has the disparity d = f B (1/z − 1/z₀), x − d u its column in that view: the convention to be met.

use rayon::prelude::*;

/// Depth without parallax.
const IN_FOCUS: f32 = 4.0;

/// The parameters of the photographs.
#[derive(Clone, Copy, Debug)]
pub struct StillLife {
    /// Width and height, pixels.
    pub size: usize,
    /// Parallax of the whole scene: the disparities run from about −0.5 to 0.9 times this.
    pub parallax: f32,
    /// Standard deviation of the noise of every value.
    pub noise: f32,
    /// Rays per pixel, along each side.
    pub samples: usize,
}

/// A view of it.
pub struct Photograph {
    /// Row by row from the top.
    pub rgb: Vec<[f32; 3]>,
    /// The true disparity in the middle of each pixel.
    pub disparity: Vec<f32>,
}

enum Shape {
    /// n · p = c.
    Plane { normal: [f32; 3], distance: f32 },
    /// A part of a plane z = z₀ + slope · (p − middle), |p − middle| ≤ half.
    Card { middle: [f32; 3], slope: [f32; 2], half: [f32; 2] },
    /// A ball.
    Ball { middle: [f32; 3], radius: f32 },
    /// A flat rod that faces the eye: from, to (columns and rows at depth z), half its width.
    Rod { from: [f32; 2], to: [f32; 2], z: f32, half: f32 },
}

enum Paint {
    /// Noise of this many waves per unit.
    Mottled { waves: f32, base: [f32; 3], contrast: f32 },
    /// Stripes of this many waves per unit.
    Striped { waves: f32 },
    /// One colour.
    Flat([f32; 3]),
}

fn scene() -> Vec<(Shape, Paint)> {
    let mottled = |waves, base, contrast| Paint::Mottled { waves, base, contrast };
    vec![
        // The wall, turned.
        (Shape::Plane { normal: [0.25, 0.1, 1.0], distance: 7.0 }, mottled(6.0, [0.45, 0.42, 0.4], 0.35)),
        // The floor.
        (Shape::Plane { normal: [0.0, 1.0, 0.05], distance: 1.5 }, mottled(9.0, [0.4, 0.3, 0.2], 0.3)),
        (Shape::Ball { middle: [-1.0, 0.55, 4.2], radius: 0.8 }, mottled(10.0, [0.6, 0.3, 0.25], 0.35)),
        // Nearly without texture: found by its outline.
        (
            Shape::Card { middle: [1.1, -0.75, 4.8], slope: [0.0, 0.0], half: [0.65, 0.5] },
            Paint::Flat([0.55, 0.57, 0.6]),
        ),
        (
            Shape::Card { middle: [0.85, 0.65, 3.4], slope: [0.9, 0.3], half: [0.5, 0.45] },
            Paint::Striped { waves: 4.0 },
        ),
        (
            Shape::Rod { from: [-0.9, -1.2], to: [-0.25, 1.2], z: 2.9, half: 0.018 },
            Paint::Flat([0.85, 0.75, 0.2]),
        ),
        (
            Shape::Rod { from: [0.2, -1.2], to: [0.2, 1.2], z: 3.1, half: 0.022 },
            mottled(12.0, [0.2, 0.3, 0.55], 0.25),
        ),
        (
            Shape::Rod { from: [-1.2, -0.75], to: [1.2, -0.55], z: 3.3, half: 0.015 },
            Paint::Flat([0.1, 0.1, 0.12]),
        ),
    ]
}

/// A hash in [0, 1].
fn hash(x: i32, y: i32, z: i32) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x9E37_79B1)
        ^ (y as u32).wrapping_mul(0x85EB_CA77)
        ^ (z as u32).wrapping_mul(0xC2B2_AE3D);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    (h ^ (h >> 15)) as f32 / u32::MAX as f32
}

/// Value noise: hashes of the corners, smoothly interpolated.
fn mottle(p: [f32; 3]) -> f32 {
    let base = p.map(f32::floor);
    let part: [f32; 3] = std::array::from_fn(|k| {
        let t = p[k] - base[k];
        t * t * (3.0 - 2.0 * t)
    });
    let corner = |i: i32, j: i32, k: i32| hash(base[0] as i32 + i, base[1] as i32 + j, base[2] as i32 + k);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let row = |j, k| mix(corner(0, j, k), corner(1, j, k), part[0]);
    let plane = |k| mix(row(0, k), row(1, k), part[1]);
    mix(plane(0), plane(1), part[2])
}

impl Shape {
    /// The distance along the ray (direction with z = 1: the depth) of the intersection.
    fn meets(&self, eye: [f32; 3], to: [f32; 3]) -> Option<f32> {
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        match *self {
            Self::Plane { normal, distance } => {
                let along = (distance - dot(normal, eye)) / dot(normal, to);
                (along > 0.0).then_some(along)
            }
            Self::Card { middle, slope, half } => {
                let normal = [-slope[0], -slope[1], 1.0];
                let along = (dot(normal, middle) - dot(normal, eye)) / dot(normal, to);
                let inside = (0..2).all(|k| (eye[k] + along * to[k] - middle[k]).abs() <= half[k]);
                (along > 0.0 && inside).then_some(along)
            }
            Self::Ball { middle, radius } => {
                let away: [f32; 3] = std::array::from_fn(|k| eye[k] - middle[k]);
                let (a, b, c) = (dot(to, to), dot(away, to), dot(away, away) - radius * radius);
                let root = b * b - a * c;
                (root > 0.0).then(|| (-b - root.sqrt()) / a).filter(|along| *along > 0.0)
            }
            Self::Rod { from, to: end, z, half } => {
                let along = z - eye[2];
                let p = [eye[0] + along * to[0], eye[1] + along * to[1]];
                let axis = [end[0] - from[0], end[1] - from[1]];
                let length = axis[0].hypot(axis[1]);
                let apart = ((p[0] - from[0]) * axis[1] - (p[1] - from[1]) * axis[0]).abs() / length;
                (apart <= half).then_some(along)
            }
        }
    }
}

impl Paint {
    fn colour(&self, p: [f32; 3]) -> [f32; 3] {
        match *self {
            Self::Flat(colour) => colour,
            Self::Mottled { waves, base, contrast } => std::array::from_fn(|c| {
                let shifted = |octave: f32| p.map(|v| v * waves * octave + 17.0 * c as f32);
                base[c] + contrast * (0.6 * mottle(shifted(1.0)) + 0.4 * mottle(shifted(2.3)) - 0.5)
            }),
            Self::Striped { waves } => {
                let wave = (std::f32::consts::TAU * waves * (p[0] + 0.3 * p[1])).sin();
                [0.5 + 0.3 * wave, 0.45 + 0.2 * wave, 0.5 - 0.25 * wave]
            }
        }
    }
}

impl StillLife {
    /// The photograph from `position`, steps of the grid.
    pub fn photograph(&self, position: [f64; 2]) -> Photograph {
        let scene = scene();
        let focal = 1.3 * self.size as f32;
        // f B (1/2.9 − 1/z₀) is about 0.095 f B, at the wall (1/7 − 1/z₀) −0.107 f B.
        let baseline = self.parallax / (0.1 * focal);
        let place = position.map(|p| p as f32);
        let eye = [baseline * place[0], baseline * place[1], 0.0];
        let shift = focal * baseline / IN_FOCUS;
        let middle = 0.5 * (self.size as f32 - 1.0);
        let trace = |x: f32, y: f32| -> (f32, [f32; 3]) {
            let to = [(x - middle - shift * place[0]) / focal, (y - middle - shift * place[1]) / focal, 1.0];
            // The wall closes the scene wherever the others leave it open.
            let (along, paint) = scene
                .iter()
                .filter_map(|(shape, paint)| shape.meets(eye, to).map(|along| (along, paint)))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .expect("the wall is everywhere");
            (along, paint.colour(std::array::from_fn(|k| eye[k] + along * to[k])))
        };
        let pixel = |index: usize| -> ([f32; 3], f32) {
            let (x, y) = ((index % self.size) as f32, (index / self.size) as f32);
            let mut sum = [0.0; 3];
            for k in 0..self.samples * self.samples {
                let inside = |k: usize| (k as f32 + 0.5) / self.samples as f32 - 0.5;
                let (_, colour) = trace(x + inside(k % self.samples), y + inside(k / self.samples));
                sum.iter_mut().zip(colour).for_each(|(sum, value)| *sum += value);
            }
            let share = 1.0 / (self.samples * self.samples) as f32;
            let seed = [(100.0 * position[0]) as i32, (100.0 * position[1]) as i32];
            let colour = std::array::from_fn(|c| {
                // Twelve even values less six: nearly normal, of variance 1.
                let normal: f32 = (0..12)
                    .map(|k| hash(index as i32, 12 * c as i32 + k, seed[0] * 1009 + seed[1]))
                    .sum::<f32>()
                    - 6.0;
                sum[c] * share + self.noise * normal
            });
            let (depth, _) = trace(x, y);
            (colour, focal * baseline * (1.0 / depth - 1.0 / IN_FOCUS))
        };
        let (rgb, disparity) = (0..self.size * self.size).into_par_iter().map(pixel).unzip();
        Photograph { rgb, disparity }
    }
}
