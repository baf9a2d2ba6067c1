//! An address on the scene's surface.

use crate::Scene;
use glam::{DVec2, DVec3};

/// A point of a triangle: P = (1 − b₁ − b₂)·A + b₁·B + b₂·C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Index into [`Scene::triangles`].
    pub triangle: u32,
    /// b₁ and b₂, each ≥ 0 with b₁ + b₂ ≤ 1.
    pub barycentric: DVec2,
}

impl SurfacePoint {
    /// The weights of the triangle's three corners; they sum to 1.
    #[inline]
    pub fn weights(self) -> [f64; 3] {
        let DVec2 { x: b1, y: b2 } = self.barycentric;
        [1.0 - b1 - b2, b1, b2]
    }

    /// The point in world space.
    #[inline]
    pub fn position(self, scene: &Scene) -> DVec3 {
        let [a, b, c] = scene.corners(self.triangle);
        let [wa, wb, wc] = self.weights();
        a * wa + b * wb + c * wc
    }

    /// The same of a point that may be of another scene; none where this one has no such triangle.
    pub fn checked_position(self, scene: &Scene) -> Option<DVec3> {
        ((self.triangle as usize) < scene.triangles.len()).then(|| self.position(scene))
    }
}

/// A value at every point of the scene's surface, and at infinity (the background).
pub trait SurfaceField<T>: Sync {
    /// The value at a surface point.
    fn at(&self, point: SurfacePoint) -> T;
    /// The value of the background.
    fn at_infinity(&self) -> T;
    /// The least and the greatest value over a triangle, each number by itself: bounds that no point of it
    /// passes. `None` if the field does not know; who needs them then has to look.
    fn bounds(&self, _triangle: u32) -> Option<[T; 2]> {
        None
    }
    /// Whether any value says something of the light that surfaces carry (mirror, let through), too. Where none does, nobody
    /// need look for that light; a field that does not know says yes.
    fn affects_carried_light(&self) -> bool {
        true
    }
}
