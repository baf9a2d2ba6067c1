//! Cloth's fuzz: Charlie's microfibres (Estevez and Kulla 2017) with the visibility term of Ashikhmin and Premože, as in
//! KHR_materials_sheen.

use glam::DVec3;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Number of cosines and of roughnesses in the albedo table.
const SIDE: usize = 32;
/// Number of steps of either angle that are summed for an entry.
const STEPS: usize = 96;
/// The smallest roughness: below it the lobe would be a line along the horizon.
const SMOOTHEST: f64 = 0.07;

/// Value of the lobe for white, 1/sr. Directions in the surface's axes, z > 0.
pub fn value(o: DVec3, i: DVec3, roughness: f64) -> f64 {
    let Some(h) = (o + i).try_normalize() else { return 0.0 };
    let inverse_alpha = 1.0 / roughness.max(SMOOTHEST).powi(2);
    let sin = (1.0 - h.z * h.z).max(0.0).sqrt();
    let density = (2.0 + inverse_alpha) * sin.powf(inverse_alpha) / (2.0 * PI);
    density / (4.0 * (o.z + i.z - o.z * i.z))
}

/// The albedo of white sheen, in [0, 1], seen at an angle with this cosine; `roughness` in [0, 1].
pub fn albedo(cos: f64, roughness: f64) -> f64 {
    static TABLE: OnceLock<Vec<f64>> = OnceLock::new();
    let table = TABLE.get_or_init(|| {
        let entry = |k: usize| {
            let [cos, roughness] = [k % SIDE, k / SIDE].map(|k| k as f64 / (SIDE - 1) as f64);
            integrate(cos.max(1e-3), roughness)
        };
        (0..SIDE * SIDE).map(entry).collect()
    });
    let place = |x: f64| {
        let place = x.clamp(0.0, 1.0) * (SIDE - 1) as f64;
        let k = (place as usize).min(SIDE - 2);
        (k, place - k as f64)
    };
    let ((c, cs), (r, rs)) = (place(cos), place(roughness));
    let line = |r: usize| table[r * SIDE + c] * (1.0 - cs) + table[r * SIDE + c + 1] * cs;
    line(r) * (1.0 - rs) + line(r + 1) * rs
}

fn integrate(cos: f64, roughness: f64) -> f64 {
    let o = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let step = |k: usize| {
        // Over z² and half the azimuths: the lobe is symmetric.
        let [u, v] = [k % STEPS, k / STEPS].map(|k| (k as f64 + 0.5) / STEPS as f64);
        let (sin, cos) = (PI * v).sin_cos();
        let z = u.sqrt();
        let flat = (1.0 - u).sqrt();
        value(o, DVec3::new(flat * cos, flat * sin, z), roughness) * PI
    };
    let sum: f64 = (0..STEPS * STEPS).map(step).sum();
    // Sheen that creates light is a fault of the model at grazing angles: it reflects all light at most.
    (sum / (STEPS * STEPS) as f64).min(1.0)
}
