//! Numbers drawn for a surface point: the same for the same point.

use scene::SurfacePoint;

/// Three numbers in [0, 1) for a surface point.
pub(crate) fn draw(point: SurfacePoint) -> [f64; 3] {
    let words = [u64::from(point.triangle), point.barycentric.x.to_bits(), point.barycentric.y.to_bits()];
    let mut state = words.into_iter().fold(0, |state, word| mix(state ^ word));
    std::array::from_fn(|_| {
        state = mix(state);
        (state >> 11) as f64 / (1u64 << 53) as f64
    })
}

/// SplitMix64 (Steele, Lea and Flood 2014).
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
