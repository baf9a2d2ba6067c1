//! What viewpoints see of squares.

use super::{LeafTriangle, Tracer};
use crate::hierarchy::{Node, Visit};
use crate::sight::{Eye, Looking, PlaceSet, Places, Sight, Square, Viewpoint};
use crate::watertight::ShearedRay;
use glam::DVec3;
use scene::SurfacePoint;
use std::ops::Range;

impl Tracer {
    /// What a viewpoint sees of the `places` of a square: of each what [`Self::hidden`] (or, from infinity, [`Self::any_hit`])
    /// says of the ray to it, to the precision of f32 in u and v, for the cost of a few; but what is half there hides by its
    /// share.
    pub fn sight(&self, from: Viewpoint, square: &Square, places: &Places) -> Sight {
        let (eye, skip) = match from {
            Viewpoint::Surface(point) => (Eye::At(point.position(&self.scene)), Some(point.triangle)),
            Viewpoint::Infinity(direction) => (Eye::Toward(direction.normalize_or_zero()), None),
        };
        let looking = Looking::new(eye, square, places, &self.space);
        let mut sight = Sight::past(self.behind_own_face(from, square, places));
        let mut watch = Watch { tracer: self, looking: &looking, places, skip, sight: &mut sight };
        self.hierarchy.walk_within(&looking.shaft(&self.space), f32::INFINITY, &mut watch);
        sight
    }

    /// Those of the places of a square that the back of the viewpoint's own face would be seen from.
    fn behind_own_face(&self, from: Viewpoint, square: &Square, places: &Places) -> PlaceSet {
        let Viewpoint::Surface(point) = from else { return PlaceSet::default() };
        if !self.scene.hides_back(point.triangle) {
            return PlaceSet::default();
        }
        let (normal, position) = (self.scene.area_normal(point.triangle), point.position(&self.scene));
        let is_behind = |place: DVec3| normal.dot(place - position) <= 0.0;
        if !square.corners().into_iter().any(is_behind) {
            return PlaceSet::default();
        }
        places.all().iter().filter(|&place| is_behind(square.at(places.at(place)))).collect()
    }

    /// Takes from the sight of some places what a triangle in between takes: its opacity where their rays meet it.
    #[cold]
    fn dim(
        &self,
        sight: &mut Sight,
        triangle: &LeafTriangle,
        looking: &Looking,
        places: &Places,
        some: PlaceSet,
    ) {
        for place in some.iter() {
            let ray = looking.ray(places.at(place));
            let Some(crossing) = ShearedRay::new(ray.origin, ray.direction).cross(&triangle.corners) else {
                continue;
            };
            let point = SurfacePoint { triangle: triangle.index, barycentric: crossing.barycentric };
            sight.dim(place, self.scene.opacity(point));
        }
    }
}

/// A walk from a viewpoint to a square.
struct Watch<'a> {
    tracer: &'a Tracer,
    looking: &'a Looking<'a>,
    places: &'a Places,
    /// The triangle that the viewpoint lies on.
    skip: Option<u32>,
    sight: &'a mut Sight,
}

impl Visit for Watch<'_> {
    /// Without what could hide only what is hidden.
    #[inline(always)]
    fn wanted(&mut self, node: &Node, reached: u32) -> u32 {
        match self.sight.hidden.is_empty() {
            true => reached,
            false => self.looking.may_hide_more(node, reached, self.sight.hidden),
        }
    }

    #[inline(always)]
    fn leaf(&mut self, items: Range<usize>) -> f32 {
        let triangles = &self.tracer.triangles[items.clone()];
        let Self { tracer, looking, sight, .. } = self;
        looking.each_near(&tracer.outlines[items], |at, near| {
            let near = near - sight.hidden;
            if near.is_empty() {
                return;
            }
            let triangle = &triangles[at];
            if self.skip == Some(triangle.index) {
                return;
            }
            let mut new = looking.newly_hidden(&triangle.corners, near);
            // The places lie on its other side than the viewpoint.
            if triangle.hides_back && !new.is_empty() && looking.sees_front(&triangle.corners) {
                new = PlaceSet::default();
            }
            if triangle.may_be_transparent && !new.is_empty() {
                tracer.dim(sight, triangle, looking, self.places, new);
            } else {
                sight.hidden |= new;
            }
        });
        if self.sight.hidden == self.places.all() { f32::NEG_INFINITY } else { f32::INFINITY }
    }
}
