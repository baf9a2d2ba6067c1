//! A surface point, as irradiance is asked for.

use glam::DVec3;
use scene::{Scene, SurfacePoint};

/// Where a surface point lies and how it faces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub position: DVec3,
    /// On the side that is asked for; unit, without bumps.
    pub normal: DVec3,
    pub part: u32,
}

impl Place {
    /// A point of the scene, on its front or back.
    pub fn new(scene: &Scene, point: SurfacePoint, is_front: bool) -> Self {
        let normal = scene.shading_normal(point);
        Self {
            position: point.position(scene),
            normal: if is_front { normal } else { -normal },
            part: scene.triangles[point.triangle as usize].part,
        }
    }
}
