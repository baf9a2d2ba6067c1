//! The shadow of a triangle on a square.
//!
//! From a point P the place U of the square lies behind a triangle q₀q₁q₂ if
//!
//! ```text
//! s·(U − P)·(q₁×q₂) ≥ 0,  s·(U − P)·(q₂×q₀) ≥ 0,  s·(U − P)·(q₀×q₁) ≥ 0,  s·((U − P)·n − n·q₀) > 0
//! ```
//!
//! with corners relative to P, n the triangle's normal and s the sign of n·q₀: the ray passes within its three edges, and
//! U lies beyond its plane. All four are linear in U, and so in the coordinates u, v of the square: a triangle is set up
//! once and tried on all places with two multiplications each. Two triangles that share an edge have exactly opposite
//! functions there, so that no ray passes between them. Toward a point at infinity the same holds with its direction.

use crate::visibility::{Eye, Square};
use glam::DVec3;

/// A linear function of u and v.
#[derive(Clone, Copy)]
struct Linear([f32; 3]);

impl Linear {
    /// a·u + b·v + c, scaled.
    fn new(a: f64, b: f64, c: f64) -> Self {
        // A power of two, that of the function with the opposite sign too.
        let largest = a.abs().max(b.abs()).max(c.abs());
        let exponent = (largest.to_bits() >> 52).min(2045);
        let scale = f64::from_bits((2046 - exponent) << 52);
        Self([(a * scale) as f32, (b * scale) as f32, (c * scale) as f32])
    }

    /// The value of the linear function at a place with these coordinates.
    #[inline(always)]
    fn evaluate(self, [u, v]: [f32; 2]) -> f32 {
        let [a, b, c] = self.0;
        (a * u + b * v) + c
    }

    /// An upper bound of [`Self::evaluate`] on the square, rounded likewise.
    #[inline(always)]
    fn max_on_square(self) -> f32 {
        let [a, b, c] = self.0;
        (a.abs() + b.abs()) + c
    }
}

/// The places behind a triangle: where its edges' functions are not negative, and that of its plane is positive.
pub(super) struct Shadow {
    edges: [Linear; 3],
    beyond: Linear,
}

impl Shadow {
    /// The shadow that a triangle casts on a square from `eye`; `None` if it throws none there: it is seen
    /// along its plane, or the whole square lies before that plane or beside an edge.
    #[inline(always)]
    pub fn cast(corners: &[DVec3; 3], eye: Eye, square: &Square) -> Option<Self> {
        let Square { center, right, up } = *square;
        match eye {
            Eye::At(point) => {
                let [a, b, c] = [corners[0] - point, corners[1] - point, corners[2] - point];
                let to_square = center - point;
                let normal = (b - a).cross(c - a);
                let height = normal.dot(a);
                let sign = height.signum();
                let linear = |n: DVec3, offset: f64| {
                    Linear::new(sign * n.dot(right), sign * n.dot(up), sign * (n.dot(to_square) - offset))
                };
                let edge = |from: DVec3, to: DVec3| linear(from.cross(to), 0.0);
                Self::within(height != 0.0, linear(normal, height), [(b, c), (c, a), (a, b)], edge)
            }
            Eye::Toward(direction) => {
                let [a, b, c] = [corners[0] - center, corners[1] - center, corners[2] - center];
                let normal = (b - a).cross(c - a);
                let facing = normal.dot(direction);
                let sign = facing.signum();
                let edge = |from: DVec3, to: DVec3| {
                    let along = direction.cross(to - from);
                    let offset = direction.dot(from.cross(to));
                    Linear::new(sign * along.dot(right), sign * along.dot(up), sign * offset)
                };
                let beyond =
                    Linear::new(-sign * normal.dot(right), -sign * normal.dot(up), sign * normal.dot(a));
                Self::within(facing != 0.0, beyond, [(b, c), (c, a), (a, b)], edge)
            }
        }
    }

    /// A bit for each of some places, by their coordinates, that lies behind the triangle.
    #[inline(always)]
    pub fn covers<const COUNT: usize>(&self, [u, v]: &[[f32; COUNT]; 2]) -> u32 {
        let [a, b, c] = self.edges;
        let mut covered = 0;
        for k in 0..COUNT {
            let at = [u[k], v[k]];
            let is_within = (a.evaluate(at) >= 0.0) & (b.evaluate(at) >= 0.0) & (c.evaluate(at) >= 0.0);
            covered |= u32::from(is_within & (self.beyond.evaluate(at) > 0.0)) << k;
        }
        covered
    }

    /// From its parts, as long as each leaves something of the square.
    #[inline(always)]
    fn within(
        is_faced: bool,
        beyond: Linear,
        sides: [(DVec3, DVec3); 3],
        edge: impl Fn(DVec3, DVec3) -> Linear,
    ) -> Option<Self> {
        if !is_faced || beyond.max_on_square() <= 0.0 {
            return None;
        }
        let mut edges = [beyond; 3];
        for k in 0..3 {
            let (from, to) = sides[k];
            edges[k] = edge(from, to);
            if edges[k].max_on_square() < 0.0 {
                return None;
            }
        }
        Some(Self { edges, beyond })
    }
}
