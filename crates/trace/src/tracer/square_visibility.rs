//! Visibility of squares from viewpoints.

use super::{LeafTriangle, Tracer};
use crate::hierarchy::{Node, Visit};
use crate::visibility::{
    Eye, OutlineGroup, PointSet, Square, SquareVisibility, TargetPoints, Viewpoint, VisibilityQuery,
    shaft_from_many,
};
use crate::watertight::ShearedRay;
use glam::DVec3;
use numerics::with_widest_simd;
use scene::SurfacePoint;
use std::ops::Range;

/// What may stand between some viewpoints and a square: found in one traversal, for the visibility from each of them.
pub struct SquareOccluders<'a> {
    tracer: &'a Tracer,
    square: &'a Square,
    /// Places in the order of the leaves.
    triangles: Vec<u32>,
    /// Of the same.
    outlines: Vec<OutlineGroup>,
}

impl SquareOccluders<'_> {
    /// The visibility of `points` of the square from one of the viewpoints: what [`Tracer::square_visibility`] finds; the
    /// shares that partly transparent surfaces leave to the precision of f32.
    pub fn visibility(&self, from: Viewpoint, points: &TargetPoints) -> SquareVisibility {
        let Self { tracer, square, .. } = *self;
        let (eye, skip) = tracer.eye(from);
        let query = VisibilityQuery::new(eye, square, points, &tracer.space);
        let mut visibility = SquareVisibility::from_hidden(tracer.behind_own_face(from, square, points));
        let mut visitor =
            VisibilityVisitor { tracer, query: &query, points, skip, visibility: &mut visibility };
        with_widest_simd(
            #[inline(always)]
            || {
                for (triangles, outlines) in self.triangles.chunks(OutlineGroup::MAX).zip(&self.outlines) {
                    query.visit_near_of_group(
                        outlines,
                        triangles.len(),
                        #[inline(always)]
                        |at, near| visitor.visit(&tracer.triangles[triangles[at] as usize], near),
                    );
                    if visitor.sees_nothing() {
                        break;
                    }
                }
            },
        );
        visibility
    }
}

impl Tracer {
    /// What may stand between viewpoints and a square. `None` if the viewpoints lie on both sides of the square.
    pub fn square_occluders<'a>(
        &'a self,
        from: &[Viewpoint],
        square: &'a Square,
    ) -> Option<SquareOccluders<'a>> {
        let eyes: Vec<Eye> = from.iter().map(|from| self.eye(*from).0).collect();
        let shaft = shaft_from_many(&eyes, square, &self.space)?;
        let mut triangles = Vec::new();
        with_widest_simd(
            #[inline(always)]
            || {
                self.hierarchy.walk_halfspaces(&shaft, f32::INFINITY, &mut |leaf: Range<usize>| {
                    triangles.extend(leaf.start as u32..leaf.end as u32);
                    f32::INFINITY
                });
            },
        );
        let outlines = triangles.chunks(OutlineGroup::MAX).map(|places| {
            let mut outlines = [self.outlines[places[0] as usize]; OutlineGroup::MAX];
            for (outline, &place) in outlines.iter_mut().zip(places) {
                *outline = self.outlines[place as usize];
            }
            OutlineGroup::new(&outlines[..places.len()])
        });
        let outlines = outlines.collect();
        Some(SquareOccluders { tracer: self, square, triangles, outlines })
    }

    /// A viewpoint in the world, and the triangle that it lies on.
    fn eye(&self, from: Viewpoint) -> (Eye, Option<u32>) {
        match from {
            Viewpoint::Surface(point) => (Eye::At(point.position(&self.scene)), Some(point.triangle)),
            Viewpoint::Infinity(direction) => (Eye::Toward(direction.normalize_or_zero()), None),
        }
    }

    /// The visibility of `points` on a square from a viewpoint. For each point it equals [`Self::is_hidden_from`] (or, from
    /// infinity, [`Self::any_hit`]) along the ray to it, to the precision of f32 in u and v, at a much lower cost; partly
    /// transparent occluders attenuate by their opacity.
    pub fn square_visibility(
        &self,
        from: Viewpoint,
        square: &Square,
        points: &TargetPoints,
    ) -> SquareVisibility {
        let (eye, skip) = self.eye(from);
        let query = VisibilityQuery::new(eye, square, points, &self.space);
        let mut visibility = SquareVisibility::from_hidden(self.behind_own_face(from, square, points));
        let mut visitor =
            VisibilityVisitor { tracer: self, query: &query, points, skip, visibility: &mut visibility };
        let shaft = query.shaft(&self.space);
        with_widest_simd(
            #[inline(always)]
            || self.hierarchy.walk_halfspaces(&shaft, f32::INFINITY, &mut visitor),
        );
        visibility
    }

    /// The visibility of `points` where these are `hidden` by opaque surfaces: what [`Self::square_visibility`] finds, if they are those
    /// that a [device](crate::PreparedSight) found.
    pub fn visibility_from_hidden(
        &self,
        from: Viewpoint,
        square: &Square,
        points: &TargetPoints,
        mut hidden: PointSet,
    ) -> SquareVisibility {
        hidden |= self.behind_own_face(from, square, points);
        SquareVisibility::from_hidden(hidden)
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
        let Self { tracer, query, .. } = *self;
        let triangles = &tracer.triangles[items.clone()];
        query.visit_near_triangles(
            &tracer.outlines[items],
            #[inline(always)]
            |at, near| self.visit(&triangles[at], near),
        );
        if self.sees_nothing() { f32::NEG_INFINITY } else { f32::INFINITY }
    }
}

impl VisibilityVisitor<'_> {
    /// Hides what a triangle hides of the points `near` its outline.
    #[inline(always)]
    fn visit(&mut self, triangle: &LeafTriangle, near: PointSet) {
        let Self { tracer, query, points, skip, ref mut visibility } = *self;
        let near = near - visibility.hidden;
        if near.is_empty() || skip == Some(triangle.index) {
            return;
        }
        let mut new = query.newly_hidden(&triangle.corners, near);
        // The triangle is culled: the viewpoint is in front of it, the points are behind.
        if triangle.culls_back && !new.is_empty() && query.is_in_front_of(&triangle.corners) {
            new = PointSet::default();
        }
        if triangle.may_be_transparent && !new.is_empty() {
            tracer.attenuate(visibility, triangle, query, points, new);
        } else {
            visibility.hidden |= new;
        }
    }

    /// Whether all points are hidden.
    #[inline(always)]
    fn sees_nothing(&self) -> bool {
        self.visibility.hidden == self.points.all()
    }
}
