//! Addresses on a surface of triangles, and values at every point of it.
//!
//! What is known of a surface point by its address alone needs no scene: a light field is drawn, and painted, wherever its samples'
//! addresses are known.

use glam::{DVec2, DVec3};
use std::sync::Arc;

/// A point of a triangle: P = (1 − b₁ − b₂)·A + b₁·B + b₂·C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Its number among the triangles of the surface.
    pub triangle: u32,
    /// b₁ and b₂, each ≥ 0 with b₁ + b₂ ≤ 1.
    pub barycentric: DVec2,
}

/// A surface of triangles, numbered from 0.
pub trait TriangleSurface {
    /// How many there are.
    fn triangle_count(&self) -> usize;
    /// The corners A, B, C of a triangle, in the world.
    fn corners(&self, triangle: u32) -> [DVec3; 3];
}

impl<T: TriangleSurface> TriangleSurface for Arc<T> {
    fn triangle_count(&self) -> usize {
        (**self).triangle_count()
    }
    #[inline]
    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        (**self).corners(triangle)
    }
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
    pub fn position(self, surface: &impl TriangleSurface) -> DVec3 {
        let [a, b, c] = surface.corners(self.triangle);
        let [wa, wb, wc] = self.weights();
        a * wa + b * wb + c * wc
    }

    /// The same for a point that may belong to another surface; `None` if this one has no such triangle.
    pub fn checked_position(self, surface: &impl TriangleSurface) -> Option<DVec3> {
        ((self.triangle as usize) < surface.triangle_count()).then(|| self.position(surface))
    }
}

/// A value at every point of the surface, and at infinity (the background).
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

#[cfg(test)]
mod tests {
    use super::*;

    struct OneTriangle;

    impl TriangleSurface for OneTriangle {
        fn triangle_count(&self) -> usize {
            1
        }
        fn corners(&self, _triangle: u32) -> [DVec3; 3] {
            [DVec3::ZERO, DVec3::X, DVec3::Y]
        }
    }

    #[test]
    fn an_address_is_a_place_where_there_is_such_a_triangle() {
        let at = |triangle| SurfacePoint { triangle, barycentric: DVec2::new(0.25, 0.5) };
        assert_eq!(at(0).weights(), [0.25, 0.25, 0.5]);
        assert_eq!(at(0).position(&OneTriangle), DVec3::new(0.25, 0.5, 0.0));
        assert_eq!(at(0).checked_position(&Arc::new(OneTriangle)), Some(DVec3::new(0.25, 0.5, 0.0)));
        assert_eq!(at(1).checked_position(&OneTriangle), None);
    }
}
