//! Unlit and emissive surfaces, and Lambert under direct light with shadows.

use glam::{DVec3, Vec3};
use scene::SurfacePoint;
use std::sync::Arc;
use trace::{Radiance, Tracer};

/// Radiance of unlit, emissive and diffuse surfaces.
pub struct DirectLight {
    tracer: Arc<Tracer>,
    background: Vec3,
}

impl DirectLight {
    /// Prepares the scene in `tracer`; `background` is the radiance where no surface is.
    pub fn new(tracer: Arc<Tracer>, background: Vec3) -> Self {
        Self { tracer, background }
    }
}

impl Radiance for DirectLight {
    fn toward(&self, _point: SurfacePoint, _eye: DVec3) -> Vec3 {
        let _ = &self.tracer;
        todo!()
    }
    fn from_infinity(&self, _direction: DVec3) -> Vec3 {
        self.background
    }
}
