//! Transparency of surface points: masks and blending.

use crate::Ray;
use crate::random::{mix, unit};
use scene::{Scene, SurfacePoint};

/// How rays hit partly transparent surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TransparencyMode {
    /// With the probability of their opacity: the mean over many rays is right.
    Stochastic,
    /// Always, unless fully transparent: the caller weights the light by opacity.
    Fractional,
}

impl TransparencyMode {
    /// Whether `ray` hits `point`. Under a mask the opacity is 0 or 1, and both modes agree.
    pub fn is_hit(self, scene: &Scene, point: SurfacePoint, ray: &Ray) -> bool {
        let opacity = f64::from(scene.opacity(point));
        match self {
            Self::Stochastic => random_threshold(ray, point.triangle) < opacity,
            Self::Fractional => opacity > 0.0,
        }
    }
}

/// A number in [0, 1), uniform over rays and triangles, the same every time.
fn random_threshold(ray: &Ray, triangle: u32) -> f64 {
    let words = [ray.origin, ray.direction].into_iter().flat_map(|v| v.to_array().map(f64::to_bits));
    unit(words.fold(u64::from(triangle), |hash, word| mix(hash ^ word)))
}
