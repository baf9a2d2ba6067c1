//! Repeatable randomness: hashes and smooth noise.

use glam::{Vec2, Vec3};

/// A number in [0, 1) for three integers.
pub fn hash(x: i32, y: i32, z: i32) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x8da6_b343)
        ^ (y as u32).wrapping_mul(0xd816_3841)
        ^ (z as u32).wrapping_mul(0xcb1a_b31f);
    h ^= h >> 16;
    h = h.wrapping_mul(0x7feb_352d);
    h ^= h >> 15;
    h = h.wrapping_mul(0x846c_a68b);
    h ^= h >> 16;
    (h >> 8) as f32 / (1 << 24) as f32
}

/// Smooth noise in [0, 1], features about 1 apart.
pub fn noise(p: Vec3) -> f32 {
    let cell = p.floor();
    let f = p - cell;
    let s = f * f * (Vec3::splat(3.0) - 2.0 * f);
    let [x, y, z] = cell.to_array().map(|c| c as i32);
    let at = |i: i32, j: i32, k: i32| hash(x + i, y + j, z + k);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let row = |j, k| mix(at(0, j, k), at(1, j, k), s.x);
    mix(mix(row(0, 0), row(1, 0), s.y), mix(row(0, 1), row(1, 1), s.y), s.z)
}

/// Four octaves of [`noise`], in [0, 1].
pub fn rough(p: Vec3) -> f32 {
    (noise(p) + noise(p * 2.1 + 7.3) / 2.0 + noise(p * 4.3 + 3.1) / 4.0 + noise(p * 8.7 + 1.7) / 8.0) / 1.875
}

/// The R2 sequence: evenly spread points in the unit square.
pub fn spread(index: usize) -> Vec2 {
    let i = index as f64 + 0.5;
    Vec2::new((i * 0.754_877_666_246_692_7).fract() as f32, (i * 0.569_840_290_998_053_2).fract() as f32)
}

/// 0 below `low`, 1 above `high`, smooth between.
pub fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
