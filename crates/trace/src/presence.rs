//! Whether a surface point is there: masks and blending.

use crate::Ray;
use scene::{Scene, SurfacePoint};

/// Whether `point` is there for `ray`: if a number drawn for the ray and the triangle falls below the point's
/// opacity. Under a mask the opacity is 0 or 1 and the draw decides nothing.
pub(crate) fn is_there(scene: &Scene, point: SurfacePoint, ray: &Ray) -> bool {
    draw(ray, point.triangle) < f64::from(scene.opacity(point))
}

/// A number in [0, 1), uniform over rays and triangles, the same every time.
fn draw(ray: &Ray, triangle: u32) -> f64 {
    let words = [ray.origin, ray.direction].into_iter().flat_map(|v| v.to_array().map(f64::to_bits));
    let hash = words.fold(u64::from(triangle), |hash, word| mix(hash ^ word));
    (hash >> 11) as f64 / (1u64 << 53) as f64
}

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014), preceded by its increment so that 0 is mixed as
/// well.
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
