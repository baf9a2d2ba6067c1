//! What of a square a point sees: the shadow rays to many places of it, all at once.
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

mod place_set;
mod places;
mod projection;

use crate::Ray;
use crate::hierarchy::Halfspaces;
use crate::local_space::LocalSpace;
use crate::watertight::in_plane;
use glam::{DVec2, DVec3, Vec4};
pub use place_set::PlaceSet;
pub use places::Places;
pub(crate) use projection::Outline;
use projection::Projection;
use scene::SurfacePoint;

/// A square of points in the world: `center` + u·`right` + v·`up`, u and v in [−1, 1].
#[derive(Clone, Copy, Debug)]
pub struct Square {
    /// Its middle.
    pub center: DVec3,
    /// To the middle of its side at u = 1; its length is half a side.
    pub right: DVec3,
    /// To the middle of its side at v = 1; at a right angle to `right`, and as long.
    pub up: DVec3,
}

impl Square {
    /// The world position of a place.
    pub fn at(&self, place: DVec2) -> DVec3 {
        self.center + place.x * self.right + place.y * self.up
    }

    fn corners(&self) -> [DVec3; 4] {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(u, v)| self.at(DVec2::new(u, v)))
    }

    fn axis(&self) -> DVec3 {
        self.right.cross(self.up).normalize_or_zero()
    }
}

/// Where a square is looked at from.
#[derive(Clone, Copy, Debug)]
pub enum Viewpoint {
    /// A point on a surface, which does not hide the square itself.
    Surface(SurfacePoint),
    /// Infinitely far in this direction from the square.
    Infinity(DVec3),
}

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
        Self([a, b, c].map(|part| (part * scale) as f32))
    }

    #[inline(always)]
    fn of(self, [u, v]: [Vec4; 2]) -> Vec4 {
        let [a, b, c] = self.0.map(Vec4::splat);
        (a * u + b * v) + c
    }
}

/// The places behind a triangle: where its edges' functions are not negative, and that of its plane is positive.
struct Shadow {
    edges: [Linear; 3],
    beyond: Linear,
}

/// A viewpoint in the world.
#[derive(Clone, Copy)]
pub(crate) enum Eye {
    /// A point.
    At(DVec3),
    /// A direction.
    Toward(DVec3),
}

/// A viewpoint and the square it looks at.
pub(crate) struct Looking<'a> {
    eye: Eye,
    square: &'a Square,
    places: &'a Places,
    /// The square's axis, away from the viewpoint.
    axis: DVec3,
    projection: Projection,
}

impl<'a> Looking<'a> {
    pub fn new(eye: Eye, square: &'a Square, places: &'a Places, space: &LocalSpace) -> Self {
        let axis = square.axis();
        let away = match eye {
            Eye::At(point) => square.center - point,
            Eye::Toward(direction) => -direction,
        };
        let axis = if axis.dot(away) < 0.0 { -axis } else { axis };
        Self { eye, square, places, axis, projection: Projection::new(eye, square, axis, space) }
    }

    /// The part of the world between the two, generously, and the direction in which it widens.
    pub fn shaft(&self, space: &LocalSpace) -> Halfspaces {
        let corners = self.square.corners().map(|corner| space.position(corner));
        let center = space.position(self.square.center);
        let mut shaft = Halfspaces::toward(self.axis);
        for k in 0..4 {
            let (a, b) = (corners[k], corners[(k + 1) % 4]);
            let (on, normal) = match self.eye {
                Eye::At(point) => {
                    let point = space.position(point);
                    (point, (a - point).cross(b - point))
                }
                Eye::Toward(direction) => (a, direction.cross(b - a)),
            };
            shaft.add(normal, on, center);
        }
        shaft.add(self.axis, center, center - self.axis);
        shaft
    }

    /// The ray to a place of the square.
    pub fn ray(&self, place: DVec2) -> Ray {
        let place = self.square.at(place);
        match self.eye {
            Eye::At(origin) => Ray { origin, direction: place - origin, t_min: 0.0, t_max: 1.0, skip: None },
            Eye::Toward(direction) => {
                Ray { origin: place, direction, t_min: 0.0, t_max: f64::INFINITY, skip: None }
            }
        }
    }

    #[inline(always)]
    fn shadow(&self, corners: &[DVec3; 3]) -> Option<Shadow> {
        let Square { center, right, up } = *self.square;
        match self.eye {
            Eye::At(point) => {
                let [a, b, c] = corners.map(|corner| corner - point);
                let to_square = center - point;
                let normal = (b - a).cross(c - a);
                let height = normal.dot(a);
                let sign = height.signum();
                let linear = |n: DVec3, offset: f64| {
                    Linear::new(sign * n.dot(right), sign * n.dot(up), sign * (n.dot(to_square) - offset))
                };
                let edges = [linear(b.cross(c), 0.0), linear(c.cross(a), 0.0), linear(a.cross(b), 0.0)];
                (height != 0.0).then(|| Shadow { edges, beyond: linear(normal, height) })
            }
            Eye::Toward(direction) => {
                let [a, b, c] = corners.map(|corner| corner - center);
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
                (facing != 0.0).then(|| Shadow { edges: [edge(b, c), edge(c, a), edge(a, b)], beyond })
            }
        }
    }

    /// Those of the places that a triangle may hide, and some that it does not.
    #[inline(always)]
    pub fn may_hide(&self, outline: &Outline) -> PlaceSet {
        match self.projection.bounds(outline) {
            Some(bounds) if bounds.is_outside() => PlaceSet::default(),
            Some(bounds) => self.places.near(&bounds),
            None => self.places.all(),
        }
    }

    /// Those of the places `near` it that a triangle hides.
    #[inline(always)]
    pub fn newly_hidden(&self, corners: &[DVec3; 3], near: PlaceSet) -> PlaceSet {
        let Some(shadow) = self.shadow(corners) else { return PlaceSet::default() };
        let behind = self.places.behind(&shadow, near);
        // A line that starts in a plane does not meet it again.
        let starts_there = match self.eye {
            Eye::At(point) => !behind.is_empty() && in_plane(corners, point),
            Eye::Toward(_) => false,
        };
        if starts_there { PlaceSet::default() } else { behind }
    }
}
