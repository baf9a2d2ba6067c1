//! Visibility of a square from a point: the shadow rays to many points of it, all at once.
//!
//! A triangle's outline bounds which of the points it may hide (`projection`); its shadow decides exactly (`shadow`).

mod point_set;
mod projection;
mod shadow;
mod shaft;
mod square;
mod target_points;
mod viewpoint;

use crate::Ray;
use crate::hierarchy::{Halfspaces, Node};
use crate::local_space::LocalSpace;
use crate::watertight::in_plane;
use glam::{DVec2, DVec3};
pub use point_set::PointSet;
use projection::{Boxes, Projection};
pub(crate) use projection::{Outline, OutlineGroup};
use shadow::Shadow;
pub(crate) use shaft::shaft_from_many;
pub use square::Square;
pub use target_points::TargetPoints;
pub(crate) use viewpoint::Eye;
pub use viewpoint::Viewpoint;

/// The visibility of points on a square from a viewpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct SquareVisibility {
    /// The points that are not visible.
    pub hidden: PointSet,
    /// The transmittance toward each point through partly transparent surfaces, in (0, 1], whether hidden or not; `None` if there are
    /// no such surfaces in between.
    pub shares: Option<Box<[f32; PointSet::MAX]>>,
}

impl SquareVisibility {
    /// All points visible except the hidden ones.
    pub(crate) fn from_hidden(hidden: PointSet) -> Self {
        Self { hidden, shares: None }
    }

    /// Attenuates a point by an opacity.
    pub(crate) fn attenuate(&mut self, place: usize, opacity: f32) {
        if opacity >= 1.0 {
            self.hidden |= std::iter::once(place).collect();
        } else if opacity > 0.0 {
            let shares = self.shares.get_or_insert_with(|| Box::new([1.0; PointSet::MAX]));
            shares[place] *= 1.0 - opacity;
        }
    }
}

/// A viewpoint and the square whose visibility is computed.
pub(crate) struct VisibilityQuery<'a> {
    eye: Eye,
    square: &'a Square,
    points: &'a TargetPoints,
    /// The square's axis, away from the viewpoint.
    axis: DVec3,
    projection: Projection,
}

impl<'a> VisibilityQuery<'a> {
    /// Asks which of `points`, places of `square`, are visible from `eye`; `space` is the tracer's.
    pub fn new(eye: Eye, square: &'a Square, points: &'a TargetPoints, space: &LocalSpace) -> Self {
        let axis = square.axis();
        let away = match eye {
            Eye::At(point) => square.center - point,
            Eye::Toward(direction) => -direction,
        };
        let axis = if axis.dot(away) < 0.0 { -axis } else { axis };
        Self { eye, square, points, axis, projection: Projection::new(eye, square, axis, space) }
    }

    /// A conservative bound of the space between the two, and the direction in which it widens.
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

    /// The ray from the eye to a place of the square, each coordinate in [−1, 1]; from a distant eye it starts at the
    /// place.
    pub fn ray(&self, place: DVec2) -> Ray {
        let place = self.square.world_position(place);
        match self.eye {
            Eye::At(origin) => Ray { origin, direction: place - origin, t_min: 0.0, t_max: 1.0, skip: None },
            Eye::Toward(direction) => {
                Ray { origin: place, direction, t_min: 0.0, t_max: f64::INFINITY, skip: None }
            }
        }
    }

    /// Whether the viewpoint lies on the side of a triangle from which its corners run counter-clockwise.
    pub fn is_in_front_of(&self, corners: &[DVec3; 3]) -> bool {
        let [a, b, c] = *corners;
        let normal = (b - a).cross(c - a);
        match self.eye {
            Eye::At(point) => normal.dot(point - a) > 0.0,
            Eye::Toward(direction) => normal.dot(direction) > 0.0,
        }
    }

    /// Calls `visit` with the index of each triangle that may hide points, and a superset of those points.
    #[inline(always)]
    pub fn visit_near_triangles(&self, outlines: &[Outline], mut visit: impl FnMut(usize, PointSet)) {
        for (chunk, outlines) in outlines.chunks(Boxes::MAX).enumerate() {
            let boxes = self.projection.boxes(outlines);
            let mut left = boxes.reaching;
            while left != 0 {
                let at = left.trailing_zeros() as usize;
                left &= left - 1;
                let near = boxes.get(at).map_or(self.points.all(), |bounds| self.points.near_box(&bounds));
                visit(chunk * Boxes::MAX + at, near);
            }
        }
    }

    /// The same of a group of `count` triangles.
    #[inline(always)]
    pub fn visit_near_of_group(
        &self,
        group: &OutlineGroup,
        count: usize,
        mut visit: impl FnMut(usize, PointSet),
    ) {
        let boxes = self.projection.group_boxes(group);
        let mut left = boxes.reaching & (u32::MAX >> (u32::BITS as usize - count));
        while left != 0 {
            let at = left.trailing_zeros() as usize;
            left &= left - 1;
            visit(at, boxes.get(at).map_or(self.points.all(), |bounds| self.points.near_box(&bounds)));
        }
    }

    /// Those of a node's `reached` boxes in which triangles may hide points that are not yet `hidden`.
    #[inline(always)]
    pub fn may_hide_more(&self, node: &Node, reached: u32, hidden: PointSet) -> u32 {
        let boxes = self.projection.node_boxes(node);
        let mut candidates = reached & boxes.reaching;
        let mut left = candidates;
        while left != 0 {
            let at = left.trailing_zeros();
            left &= left - 1;
            if let Some(bounds) = boxes.get(at as usize)
                && (self.points.near_box(&bounds) - hidden).is_empty()
            {
                candidates &= !(1 << at);
            }
        }
        candidates
    }

    /// The points among `near` that a triangle with these world corners hides.
    #[inline(always)]
    pub fn newly_hidden(&self, corners: &[DVec3; 3], near: PointSet) -> PointSet {
        let Some(shadow) = Shadow::cast(corners, self.eye, self.square) else { return PointSet::default() };
        let behind = self.points.in_shadow(&shadow, near);
        // A line that starts in a plane does not meet it again.
        let starts_there = match self.eye {
            Eye::At(point) => !behind.is_empty() && in_plane(corners, point),
            Eye::Toward(_) => false,
        };
        if starts_there { PointSet::default() } else { behind }
    }
}
