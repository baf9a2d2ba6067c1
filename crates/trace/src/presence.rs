//! Whether a surface point is there: masks and blending.

use crate::Ray;
use scene::{AlphaMode, Scene, SurfacePoint};

/// How to find out whether the points of a triangle are there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Presence {
    /// They are.
    Always,
    /// Where the opacity reaches this.
    Mask(f32),
    /// For the share of rays that the opacity says.
    Blend,
}

impl Presence {
    pub fn of(alpha: AlphaMode) -> Self {
        match alpha {
            AlphaMode::Opaque => Self::Always,
            AlphaMode::Mask(cutoff) => Self::Mask(cutoff),
            AlphaMode::Blend => Self::Blend,
        }
    }
}

/// Whether `point` is there for `ray`.
#[inline(always)]
pub(crate) fn is_there(scene: &Scene, presence: Presence, point: SurfacePoint, ray: &Ray) -> bool {
    match presence {
        Presence::Always => true,
        Presence::Mask(cutoff) => opacity(scene, point) >= cutoff,
        Presence::Blend => share(ray, point.triangle) < opacity(scene, point) as f64,
    }
}

/// The opacity of a surface point: the base colour's.
fn opacity(scene: &Scene, point: SurfacePoint) -> f32 {
    scene.material_of(point.triangle).base_color.w
}

/// A number in [0, 1), uniform over rays and triangles.
fn share(ray: &Ray, triangle: u32) -> f64 {
    let words = [ray.origin, ray.direction].into_iter().flat_map(|v| v.to_array().map(f64::to_bits));
    let hash = words.fold(u64::from(triangle), |hash, word| mix(hash ^ word));
    (hash >> 11) as f64 / (1u64 << 53) as f64
}

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014), preceded by its increment so that 0 is mixed as well.
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
