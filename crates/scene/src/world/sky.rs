//! Two skies over open ground: overcast, and evening. Their front, where the sun sets, is +Z.

use glam::{DVec3, Vec3};
use numerics::smoothstep;

/// Radiance of the overcast sky at the zenith.
const OVERCAST_ZENITH: f32 = 1.25;
/// Share of the light that open ground sends back, by colour.
const GROUND: Vec3 = Vec3::new(0.2, 0.18, 0.15);

/// Elevation of the sun's middle, rad, and the angle at which its disc has faded: larger than the true 0.0047, since a map has no room for
/// less.
const SUN_ELEVATION: f64 = 0.12;
const SUN_RADIUS: f64 = 0.03;
/// Radiance of the sun's middle.
const SUN: Vec3 = Vec3::new(1900.0, 1000.0, 380.0);
/// Radiance of its glow, and how fast that falls with the angle.
const GLOW: Vec3 = Vec3::new(5.1, 2.1, 0.64);
const GLOW_FALLOFF: f32 = 5.0;
/// Radiance of the evening sky at the zenith, above the sun's horizon, and above the horizon opposite.
const DUSK_ZENITH: Vec3 = Vec3::new(0.16, 0.27, 0.54);
const SUNSET_HORIZON: Vec3 = Vec3::new(1.5, 0.83, 0.42);
const DUSK_HORIZON: Vec3 = Vec3::new(0.48, 0.43, 0.61);

/// The CIE's overcast sky, L = L_z·(1 + 2 sin θ)/3 at the elevation θ (CIE S 011, type 1 in its classical form), with soft clouds.
pub(super) fn overcast_radiance(direction: DVec3) -> Vec3 {
    let sky = |sine: f32| OVERCAST_ZENITH * (1.0 + 2.0 * sine) / 3.0;
    let clouds = 0.85 + 0.3 * clouds(direction, 1.0);
    let above = Vec3::new(0.97, 1.0, 1.05) * (sky(direction.y.max(0.0) as f32) * clouds);
    // A level plane receives 7/9 π L_z.
    let below = GROUND * (OVERCAST_ZENITH * 7.0 / 9.0);
    over_ground(direction, above, below)
}

/// A clear sky with thin clouds at sunset.
pub(super) fn evening_radiance(direction: DVec3) -> Vec3 {
    let (sin, cos) = SUN_ELEVATION.sin_cos();
    let to_sun = DVec3::new(0.0, sin, cos);
    let angle = direction.dot(to_sun).clamp(-1.0, 1.0).acos();
    let flat = DVec3::new(direction.x, 0.0, direction.z).normalize_or_zero();
    let sunward = (0.5 + 0.5 * flat.z) as f32;
    let height = direction.y.max(0.0) as f32;
    let horizon = DUSK_HORIZON.lerp(SUNSET_HORIZON, sunward * sunward);
    let sky = horizon.lerp(DUSK_ZENITH, 1.0 - (1.0 - height).powi(4));
    let glow = GLOW * (-GLOW_FALLOFF * angle as f32).exp();
    // Thin clouds, lit from below, where the sky is not too low.
    let cover = smoothstep(clouds(direction, 0.35), [0.55, 0.85]) * smoothstep(height, [0.02, 0.2]);
    let lit = Vec3::new(1.0, 0.54, 0.38) * (0.4 + 0.9 * sunward);
    let above = (sky + glow).lerp(lit + glow, 0.55 * cover);
    let disc = SUN * smoothstep(angle, [SUN_RADIUS, 0.4 * SUN_RADIUS]) as f32;
    let below = GROUND * Vec3::new(0.88, 0.64, 0.58) * (1.0 + 1.2 * sunward * sunward);
    over_ground(direction, above + disc, below)
}

/// The sky above the horizon, which fades into the ground within two degrees.
fn over_ground(direction: DVec3, above: Vec3, below: Vec3) -> Vec3 {
    below.lerp(above, smoothstep(direction.y, [-0.03, 0.005]) as f32)
}

/// Clouds on a flat layer above, in [0, 1]: smooth noise of five octaves, `stretch` times as long along x as along z.
fn clouds(direction: DVec3, stretch: f64) -> f32 {
    let height = direction.y.max(0.0) + 0.12;
    let (mut x, mut z) = (direction.x / height * stretch, direction.z / height);
    let (mut sum, mut weight, mut whole) = (0.0, 1.0, 0.0);
    for octave in 0..5 {
        sum += weight * noise(x, z, octave);
        whole += weight;
        weight *= 0.5;
        // Turned, so that the lattices do not coincide.
        (x, z) = (1.6 * x - 1.2 * z, 1.2 * x + 1.6 * z);
    }
    (sum / whole) as f32
}

/// Smooth noise in [0, 1], one value a unit square.
fn noise(x: f64, z: f64, octave: u32) -> f64 {
    let (column, row) = (x.floor(), z.floor());
    let value = |i: f64, j: f64| lattice(column as i64 + i as i64, row as i64 + j as i64, octave);
    let (u, v) = (numerics::smooth_fraction(x - column), numerics::smooth_fraction(z - row));
    let lerp = |a: f64, b: f64, share: f64| a + (b - a) * share;
    lerp(lerp(value(0.0, 0.0), value(1.0, 0.0), u), lerp(value(0.0, 1.0), value(1.0, 1.0), u), v)
}

/// A random value in [0, 1] for a point of a lattice: the finaliser of SplitMix64.
fn lattice(column: i64, row: i64, octave: u32) -> f64 {
    let mut bits = (column as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        ^ (row as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F)
        ^ u64::from(octave).wrapping_mul(0x1656_67B1_9E37_79F9);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}
