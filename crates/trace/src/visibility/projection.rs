//! Conservative projection of triangles from a viewpoint onto the square, in f32.

use crate::hierarchy::Node;
use crate::local_space::LocalSpace;
use crate::visibility::target_points::Bounds;
use crate::visibility::{Eye, Square};
use glam::{BVec4A, DVec3, Mat4, Vec3, Vec4};

/// A triangle's corners in local space, rounded: x, y and z, the last corner twice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outline([Vec4; 3]);

impl Outline {
    /// The corners of a triangle (world), in the space of the tracer.
    pub fn new(corners: &[DVec3; 3], space: &LocalSpace) -> Self {
        let [a, b, c] = corners.map(|corner| space.position(corner).as_vec3());
        Self([0, 1, 2].map(|axis| Vec4::new(a[axis], b[axis], c[axis], c[axis])))
    }
}

/// Triangles whose corners are projected at once, by corner and axis, a triangle a lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OutlineGroup([[[f32; Self::MAX]; 3]; 3]);

impl OutlineGroup {
    /// The most triangles of a group.
    pub const MAX: usize = 16;

    /// The outlines of at least one triangle, at most [`Self::MAX`].
    pub fn new(outlines: &[Outline]) -> Self {
        let last = outlines.len() - 1;
        let lane = |corner: usize, axis: usize, lane: usize| outlines[lane.min(last)].0[axis][corner];
        let of_axis = |corner, axis| std::array::from_fn(|k| lane(corner, axis, k));
        Self([0, 1, 2].map(|corner| [0, 1, 2].map(|axis| of_axis(corner, axis))))
    }
}

/// The projection from a viewpoint onto the square, of local space.
///
/// A point at c, projected from o, is at u = right·(c − o)/depth − middle.x, depth = toward·(c − o) being 1 on the square; v
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
    /// The projection from `eye` to the plane of `square`; `axis` is the square's normal, pointing away from the eye.
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

    /// The boxes in the square's plane around the projections of some triangles, at most [`Boxes::MAX`] and at least
    /// one.
    #[inline(always)]
    pub fn boxes(&self, outlines: &[Outline]) -> Boxes {
        let last = outlines.len() - 1;
        let [a, b, c, d] = [0, 1, 2, 3].map(|k: usize| &outlines[k.min(last)].0);
        // By axis and corner, a triangle a lane. Loops, not maps: those of many vectors become calls.
        let mut from_origin = [[Vec4::ZERO; 3]; 3];
        for (axis, corners) in from_origin.iter_mut().enumerate() {
            let by_corner = Mat4::from_cols(a[axis], b[axis], c[axis], d[axis]).transpose();
            let origin = Vec4::splat(self.origin[axis]);
            *corners = [by_corner.x_axis - origin, by_corner.y_axis - origin, by_corner.z_axis - origin];
        }
        let [x, y, z] = &from_origin;
        let (mut low, mut high) = ([Vec4::INFINITY; 2], [Vec4::NEG_INFINITY; 2]);
        let mut is_bounded = BVec4A::splat(true);
        for k in 0..3 {
            let along = |side: Vec3| x[k] * side.x + y[k] * side.y + z[k] * side.z;
            let (mut per_depth, mut depth_share) = (Vec4::ONE, Vec4::ZERO);
            if let Some(toward) = self.toward {
                let depth = along(toward);
                // Its error shall be small beside it.
                is_bounded &= depth.cmpgt(Vec4::splat(16.0 * self.depth_error));
                per_depth = depth.recip();
                depth_share = per_depth * (1.1 * self.depth_error);
            }
            for axis in 0..2 {
                let numerator = along(self.sides[axis]);
                let error = (numerator.abs() * depth_share + self.side_error) * (per_depth * 1.1) + SLACK;
                let at = numerator * per_depth - self.middle[axis];
                low[axis] = low[axis].min(at - error);
                high[axis] = high[axis].max(at + error);
            }
        }
        Boxes::new(low, high, is_bounded, u32::MAX >> (31 - last))
    }

    /// The boxes in the square's plane around the projections of a group of triangles: those of [`Self::boxes`].
    #[inline(always)]
    pub fn group_boxes(&self, OutlineGroup(corners): &OutlineGroup) -> GroupBoxes {
        const N: usize = OutlineGroup::MAX;
        let (mut low, mut high) = ([[f32::INFINITY; N]; 2], [[f32::NEG_INFINITY; N]; 2]);
        let mut is_bounded = [true; N];
        for [x, y, z] in corners {
            for k in 0..N {
                let from_origin = [x[k] - self.origin.x, y[k] - self.origin.y, z[k] - self.origin.z];
                let along =
                    |side: Vec3| from_origin[0] * side.x + from_origin[1] * side.y + from_origin[2] * side.z;
                let (mut per_depth, mut depth_share) = (1.0, 0.0);
                if let Some(toward) = self.toward {
                    let depth = along(toward);
                    is_bounded[k] &= depth > 16.0 * self.depth_error;
                    per_depth = 1.0 / depth;
                    depth_share = per_depth * (1.1 * self.depth_error);
                }
                for axis in 0..2 {
                    let numerator = along(self.sides[axis]);
                    let error = (numerator.abs() * depth_share + self.side_error) * (per_depth * 1.1) + SLACK;
                    let at = numerator * per_depth - self.middle[axis];
                    let (from, to) = (at - error, at + error);
                    low[axis][k] = if low[axis][k] < from { low[axis][k] } else { from };
                    high[axis][k] = if high[axis][k] > to { high[axis][k] } else { to };
                }
            }
        }
        let (mut bounded, mut reaching) = (0, 0);
        for k in 0..N {
            // A square without extent gives no bounds.
            let has_bounds = is_bounded[k] & (low[0][k] <= high[0][k]) & (low[1][k] <= high[1][k]);
            let is_outside =
                (low[0][k] > 1.0) | (high[0][k] < -1.0) | (low[1][k] > 1.0) | (high[1][k] < -1.0);
            bounded |= u32::from(has_bounds) << k;
            reaching |= u32::from(!(has_bounds & is_outside)) << k;
        }
        GroupBoxes { low, high, bounded, reaching }
    }

    /// The boxes in the square's plane around the projections of a node's boxes.
    #[inline(always)]
    pub fn node_boxes(&self, node: &Node) -> Boxes {
        let mut from_origin = node.sides;
        for (axis, sides) in from_origin.iter_mut().enumerate() {
            let origin = Vec4::splat(self.origin[axis]);
            sides.iter_mut().for_each(|side| *side -= origin);
        }
        // The least and the most that anything in the boxes lies along a side.
        let along = |side: Vec3| {
            let (mut least, mut most) = (Vec4::ZERO, Vec4::ZERO);
            for (axis, sides) in from_origin.iter().enumerate() {
                let [low, high] = [sides[0] * side[axis], sides[1] * side[axis]];
                least += low.min(high);
                most += low.max(high);
            }
            (least, most)
        };
        let (mut nearest, mut farthest, mut depth_share) = (Vec4::ONE, Vec4::ONE, Vec4::ZERO);
        let mut is_bounded = BVec4A::splat(true);
        if let Some(toward) = self.toward {
            let (least, most) = along(toward);
            is_bounded = least.cmpgt(Vec4::splat(16.0 * self.depth_error));
            (nearest, farthest) = (least.recip(), most.recip());
            depth_share = nearest * (1.1 * self.depth_error);
        }
        let (mut low, mut high) = ([Vec4::ZERO; 2], [Vec4::ZERO; 2]);
        for axis in 0..2 {
            let (least, most) = along(self.sides[axis]);
            let farthest_out = least.abs().max(most.abs());
            let error = (farthest_out * depth_share + self.side_error) * (nearest * 1.1) + SLACK;
            low[axis] = (least * nearest).min(least * farthest) - self.middle[axis] - error;
            high[axis] = (most * nearest).max(most * farthest) - self.middle[axis] + error;
        }
        Boxes::new(low, high, is_bounded, 0b1111)
    }
}

/// Boxes on the square around the triangles of a group.
pub(super) struct GroupBoxes {
    low: [[f32; OutlineGroup::MAX]; 2],
    high: [[f32; OutlineGroup::MAX]; 2],
    /// See [`Boxes`].
    bounded: u32,
    /// A bit for each box that may overlap the square.
    pub reaching: u32,
}

impl GroupBoxes {
    /// See [`Boxes::get`].
    #[inline(always)]
    pub fn get(&self, index: usize) -> Option<Bounds> {
        let is_bounded = self.bounded >> index & 1 == 1;
        let at = |sides: &[[f32; OutlineGroup::MAX]; 2]| [sides[0][index], sides[1][index]];
        is_bounded.then(|| Bounds { low: at(&self.low), high: at(&self.high) })
    }
}

/// Boxes on the square, around triangles or what boxes hold.
pub(super) struct Boxes {
    low: [[f32; Self::MAX]; 2],
    high: [[f32; Self::MAX]; 2],
    /// A bit for each box with finite bounds; the others have a corner beside the viewpoint, or behind it.
    bounded: u32,
    /// A bit for each box that may overlap the square.
    pub reaching: u32,
}

impl Boxes {
    /// The number of boxes that are computed at once.
    pub const MAX: usize = 4;

    /// From their ends, `some` of them, a bit each.
    #[inline(always)]
    fn new(low: [Vec4; 2], high: [Vec4; 2], is_bounded: BVec4A, some: u32) -> Self {
        // A square without extent gives no bounds.
        let is_bounded = is_bounded & low[0].cmple(high[0]) & low[1].cmple(high[1]);
        let is_outside = (low[0].cmpgt(Vec4::ONE) | high[0].cmplt(Vec4::NEG_ONE))
            | (low[1].cmpgt(Vec4::ONE) | high[1].cmplt(Vec4::NEG_ONE));
        Self {
            low: [low[0].to_array(), low[1].to_array()],
            high: [high[0].to_array(), high[1].to_array()],
            bounded: is_bounded.bitmask(),
            reaching: some & !(is_bounded & is_outside).bitmask(),
        }
    }

    /// The bounds in the square's plane of the box with this number; `None` if they are not finite.
    #[inline(always)]
    pub fn get(&self, index: usize) -> Option<Bounds> {
        let is_bounded = self.bounded >> index & 1 == 1;
        is_bounded.then(|| Bounds {
            low: [self.low[0][index], self.low[1][index]],
            high: [self.high[0][index], self.high[1][index]],
        })
    }
}
