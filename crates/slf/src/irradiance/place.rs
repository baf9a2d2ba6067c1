//! A surface point as an irradiance query.

use glam::DVec3;
use scene::{Scene, SurfacePoint};

/// Position and orientation of a surface point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub position: DVec3,
    /// Unit interpolated normal of the queried side, without the normal map.
    pub normal: DVec3,
    pub part: u32,
}

impl Place {
    /// The place of a point of the scene, on its front or its back.
    pub fn new(scene: &Scene, point: SurfacePoint, is_front: bool) -> Self {
        let normal = scene.shading_normal(point);
        Self {
            position: point.position(scene),
            normal: if is_front { normal } else { -normal },
            part: scene.triangles[point.triangle as usize].part,
        }
    }
}
