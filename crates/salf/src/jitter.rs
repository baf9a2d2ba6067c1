//! Deterministic jitter: uniform numbers that depend on nothing but where they are used.

/// A well-mixed 32-bit hash of three integers (Jarzynski and Olano, "Hash functions for GPU rendering", 2020: pcg3d).
fn mix(x: u32, y: u32, z: u32) -> [u32; 3] {
    let mut v = [x, y, z].map(|k| k.wrapping_mul(1664525).wrapping_add(1013904223));
    let round = |v: &mut [u32; 3]| {
        v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
        v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
        v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
    };
    round(&mut v);
    v = v.map(|k| k ^ (k >> 16));
    round(&mut v);
    v
}

/// Three uniform numbers in [0, 1).
pub fn jitter(x: u32, y: u32, z: u32) -> [f64; 3] {
    mix(x, y, z).map(|k| k as f64 / 4294967296.0)
}
