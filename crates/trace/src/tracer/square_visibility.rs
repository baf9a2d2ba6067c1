//! Visibility of squares from viewpoints.

use super::{LeafTriangle, Tracer};
use crate::hierarchy::{Node, Visit};
use crate::visibility::{Eye, PointSet, Square, SquareVisibility, TargetPoints, Viewpoint, VisibilityQuery};
use crate::watertight::ShearedRay;
use glam::DVec3;
use scene::SurfacePoint;
use std::ops::Range;

impl Tracer {
    /// The visibility of `points` on a square from a viewpoint. For each point it equals [`Self::is_hidden_from`] (or, from
    /// infinity, [`Self::any_hit`]) along the ray to it, to the precision of f32 in u and v, at a much lower cost; partly
    /// transparent occluders attenuate by their opacity.
    pub fn square_visibility(
        &self,
        from: Viewpoint,
        square: &Square,
        points: &TargetPoints,
    ) -> SquareVisibility {
        let (eye, skip) = match from {
            Viewpoint::Surface(point) => (Eye::At(point.position(&self.scene)), Some(point.triangle)),
            Viewpoint::Infinity(direction) => (Eye::Toward(direction.normalize_or_zero()), None),
        };
        let query = VisibilityQuery::new(eye, square, points, &self.space);
        let mut visibility = SquareVisibility::from_hidden(self.behind_own_face(from, square, points));
        let mut visitor =
            VisibilityVisitor { tracer: self, query: &query, points, skip, visibility: &mut visibility };
        self.hierarchy.walk_halfspaces(&query.shaft(&self.space), f32::INFINITY, &mut visitor);
        visibility
    }

    /// The points of a square from which only the back of the viewpoint's own face is visible.
    fn behind_own_face(&self, from: Viewpoint, square: &Square, points: &TargetPoints) -> PointSet {
        let Viewpoint::Surface(point) = from else { return PointSet::default() };
        if !self.scene.culls_back_face(point.triangle) {
            return PointSet::default();
        }
        let (normal, position) = (self.scene.area_normal(point.triangle), point.position(&self.scene));
        let is_behind = |place: DVec3| normal.dot(place - position) <= 0.0;
        if !square.corners().into_iter().any(is_behind) {
            return PointSet::default();
        }
        points
            .all()
            .iter()
            .filter(|&place| is_behind(square.world_position(points.position(place))))
            .collect()
    }

    /// Attenuates points by a triangle in between: by its opacity where their rays hit it.
    #[cold]
    fn attenuate(
        &self,
        visibility: &mut SquareVisibility,
        triangle: &LeafTriangle,
        query: &VisibilityQuery,
        points: &TargetPoints,
        hidden: PointSet,
    ) {
        for place in hidden.iter() {
            let ray = query.ray(points.position(place));
            let Some(crossing) = ShearedRay::new(ray.origin, ray.direction).cross(&triangle.corners) else {
                continue;
            };
            let point = SurfacePoint { triangle: triangle.index, barycentric: crossing.barycentric };
            visibility.attenuate(place, self.scene.opacity(point));
        }
    }
}

/// A traversal from a viewpoint to a square.
struct VisibilityVisitor<'a> {
    tracer: &'a Tracer,
    query: &'a VisibilityQuery<'a>,
    points: &'a TargetPoints,
    /// The triangle that the viewpoint lies on.
    skip: Option<u32>,
    visibility: &'a mut SquareVisibility,
}

impl Visit for VisibilityVisitor<'_> {
    /// Skips boxes that could hide only points that are hidden already.
    #[inline(always)]
    fn select_children(&mut self, node: &Node, reached: u32) -> u32 {
        match self.visibility.hidden.is_empty() {
            true => reached,
            false => self.query.may_hide_more(node, reached, self.visibility.hidden),
        }
    }

    #[inline(always)]
    fn leaf(&mut self, items: Range<usize>) -> f32 {
        let triangles = &self.tracer.triangles[items.clone()];
        let Self { tracer, query, visibility, .. } = self;
        query.visit_near_triangles(&tracer.outlines[items], |at, near| {
            let near = near - visibility.hidden;
            if near.is_empty() {
                return;
            }
            let triangle = &triangles[at];
            if self.skip == Some(triangle.index) {
                return;
            }
            let mut new = query.newly_hidden(&triangle.corners, near);
            // The triangle is culled: the viewpoint is in front of it, the points are behind.
            if triangle.culls_back && !new.is_empty() && query.is_in_front_of(&triangle.corners) {
                new = PointSet::default();
            }
            if triangle.may_be_transparent && !new.is_empty() {
                tracer.attenuate(visibility, triangle, query, self.points, new);
            } else {
                visibility.hidden |= new;
            }
        });
        if self.visibility.hidden == self.points.all() { f32::NEG_INFINITY } else { f32::INFINITY }
    }
}
