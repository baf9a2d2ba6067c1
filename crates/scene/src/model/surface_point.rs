//! Addresses on the scene's surface.

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

    /// The point's position in the world.
    #[inline]
    pub fn position(self, scene: &Scene) -> DVec3 {
        let [a, b, c] = scene.corners(self.triangle);
        let [wa, wb, wc] = self.weights();
        a * wa + b * wb + c * wc
    }

    /// The same for a point that may belong to another scene; `None` if this one has no such triangle.
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
    /// The minimum and maximum value over a triangle, component by component: bounds for all its points. `None` if
    /// the field cannot bound them; the caller must then evaluate it.
    fn bounds(&self, _triangle: u32) -> Option<[T; 2]> {
        None
    }
    /// Whether any value also affects the light that surfaces carry (mirror, transmit). If none does, callers can
    /// skip that light; a field that cannot decide returns true.
    fn affects_carried_light(&self) -> bool {
        true
    }
}
