//! Where triangles lie on the square as a viewpoint sees them, quickly: in f32, generously.

use crate::local_space::LocalSpace;
use crate::sight::places::Bounds;
use crate::sight::{Eye, Square};
use glam::{DVec3, Vec3, Vec4};

/// A triangle's corners in local space, rounded: x, y and z, the last corner twice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outline([Vec4; 3]);

impl Outline {
    pub fn new(corners: &[DVec3; 3], space: &LocalSpace) -> Self {
        let [a, b, c] = corners.map(|corner| space.position(corner).as_vec3());
        Self([0, 1, 2].map(|axis| Vec4::new(a[axis], b[axis], c[axis], c[axis])))
    }
}

/// The projection from a viewpoint onto the square, of local space.
///
/// A point at c, seen from o, is at u = right·(c − o)/depth − middle.x, depth = toward·(c − o) being 1 on the square; v
/// likewise. From infinity, depth is 1 everywhere.
pub(super) struct Projection {
    origin: Vec3,
    toward: Option<Vec3>,
    sides: [Vec3; 2],
    middle: [f32; 2],
    /// By what rounding changes a depth, and the numerators of u and v, at most.
    depth_error: f32,
    side_error: f32,
}

/// What rounding coordinates to f32, and the sum of three products of theirs, change a length of local space by at most: a
/// rounding each of corner, origin, difference, side, product and two sums, of lengths up to 2√3, is less than 16 units in
/// the last place of 1.
const ROUNDING: f64 = 16.0 / (1u32 << 23) as f64;

/// What rounding changes u and v by near the square, beside.
const SLACK: f32 = 1e-5;

impl Projection {
    pub fn new(eye: Eye, square: &Square, axis: DVec3, space: &LocalSpace) -> Self {
        let local = |side: DVec3| space.direction(side);
        // What measures u and v: the sides over the squares of their lengths.
        let per = |side: DVec3| local(side) / local(side).length_squared();
        let center = space.position(square.center);
        let per = [per(square.right), per(square.up)];
        let (origin, toward, sides) = match eye {
            Eye::At(point) => {
                let origin = space.position(point);
                (origin, Some(axis / axis.dot(center - origin)), per)
            }
            Eye::Toward(direction) => {
                let sheared = |side: DVec3| side - axis * (side.dot(direction) / axis.dot(direction));
                (center, None, per.map(sheared))
            }
        };
        let error = ROUNDING * (1.0 + origin.abs().max_element());
        Self {
            origin: origin.as_vec3(),
            toward: toward.map(|toward| toward.as_vec3()),
            sides: sides.map(|side| side.as_vec3()),
            middle: sides.map(|side| side.dot(center - origin) as f32),
            depth_error: (error * toward.map_or(0.0, DVec3::length)) as f32,
            side_error: (error * sides[0].length().max(sides[1].length())) as f32,
        }
    }

    /// The box around a triangle; `None` if that is not known: a corner is nearly beside the viewpoint, or behind it.
    #[inline(always)]
    pub fn bounds(&self, outline: &Outline) -> Option<Bounds> {
        let mut from_origin = outline.0;
        for (axis, coordinates) in from_origin.iter_mut().enumerate() {
            *coordinates -= Vec4::splat(self.origin[axis]);
        }
        let along = |side: Vec3| from_origin[0] * side.x + from_origin[1] * side.y + from_origin[2] * side.z;
        let (mut per_depth, mut depth_share) = (Vec4::ONE, Vec4::ZERO);
        if let Some(toward) = self.toward {
            let depth = along(toward);
            // Its error shall be small beside it.
            if !depth.cmpgt(Vec4::splat(16.0 * self.depth_error)).all() {
                return None;
            }
            per_depth = depth.recip();
            depth_share = per_depth * (1.1 * self.depth_error);
        }
        let mut bounds = Bounds { low: [0.0; 2], high: [0.0; 2] };
        for k in 0..2 {
            let numerator = along(self.sides[k]);
            let error = (numerator.abs() * depth_share + self.side_error) * (per_depth * 1.1) + SLACK;
            let at = numerator * per_depth - self.middle[k];
            bounds.low[k] = (at - error).min_element();
            bounds.high[k] = (at + error).max_element();
        }
        // Of a square without sides nothing is known.
        let is_known = (bounds.low[0] <= bounds.high[0]) & (bounds.low[1] <= bounds.high[1]);
        is_known.then_some(bounds)
    }
}
