//! The photographs of a scene, and which parts of a surface made from a picture were photographed.

use crate::{Scene, SurfacePoint, View};
use glam::DVec2;

impl Scene {
    /// Its photographs: first those that light it, then those that are only compared with.
    pub fn all_views(&self) -> impl Iterator<Item = &View> {
        self.views.iter().chain(&self.excluded_views)
    }

    /// How far a surface made from a picture was photographed at a point: 1 photographed, 0 invented; `None` for
    /// other surfaces.
    pub fn photographed_share(&self, point: SurfacePoint) -> Option<f32> {
        let picture = self.picture.as_ref()?;
        let corners =
            self.triangles[point.triangle as usize].vertices.map(|v| self.uv[0][v as usize].as_dvec2());
        let uv: DVec2 = corners.iter().zip(point.weights()).map(|(uv, weight)| *uv * weight).sum();
        Some(f32::from(picture.is_photographed_at(uv.to_array())))
    }
}
