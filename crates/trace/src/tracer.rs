//! The scene's triangles in a bounding volume hierarchy.

use crate::{Hit, Ray};
use glam::DVec3;
use scene::{Scene, SurfacePoint};
use std::sync::Arc;

/// Answers what a ray meets.
pub struct Tracer {
    scene: Arc<Scene>,
}

impl Tracer {
    /// Builds the hierarchy.
    pub fn new(scene: Arc<Scene>) -> Self {
        Self { scene }
    }

    /// The scene it traces.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The first surface that the ray meets.
    pub fn first_hit(&self, _ray: &Ray) -> Option<Hit> {
        todo!()
    }

    /// Whether anything lies strictly between a surface point and the world position `eye`.
    pub fn occluded(&self, _from: SurfacePoint, _eye: DVec3) -> bool {
        todo!()
    }

    /// Whether a ray meets any surface.
    pub fn any_hit(&self, _ray: &Ray) -> bool {
        todo!()
    }
}
