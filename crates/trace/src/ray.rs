//! A ray and what it hits.

use glam::DVec3;
use scene::SurfacePoint;

/// The points origin + t·direction for t in (t_min, t_max). World space; `direction` need not be unit.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes; t is in multiples of this.
    pub direction: DVec3,
    /// Hits at or before this t are not seen.
    pub t_min: f64,
    /// Hits at or after this t are not seen.
    pub t_max: f64,
    /// A triangle that is not seen (the one the ray starts on).
    pub skip: Option<u32>,
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// The point's address.
    pub point: SurfacePoint,
    /// Its t along the ray.
    pub t: f64,
}
