//! Rays: first hit, occlusion, and the ray-traced ground truth.

mod ray;
mod tracer;
pub mod truth;

pub use ray::{Hit, Ray};
pub use tracer::Tracer;

use glam::{DVec3, Vec3};
use scene::SurfacePoint;

/// Radiance that leaves the scene: what [`truth`] and the SALF gather.
pub trait Radiance: Sync {
    /// Linear RGB radiance leaving `point` toward the world position `eye`.
    fn toward(&self, point: SurfacePoint, eye: DVec3) -> Vec3;
    /// Linear RGB radiance arriving from the world direction `direction` where no surface is.
    fn from_infinity(&self, direction: DVec3) -> Vec3;
}
