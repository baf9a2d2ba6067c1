//! The scene's triangles in a bounding volume hierarchy.

mod beams;
mod flat;
mod splat_surface;
mod splat_tree;
mod square_visibility;

use crate::hierarchy::Hierarchy;
use crate::local_space::LocalSpace;
use crate::transparency::TransparencyMode;
use crate::visibility::Outline;
use crate::watertight::{Crossing, ShearedRay, has_area, in_plane};
use crate::{Hit, Ray};
pub use flat::{FlatHierarchy, FlatNode, FlatSpace, FlatTriangle, SplitPosition};
use glam::DVec3;
use numerics::with_widest_simd;
use scene::{AlphaMode, Scene, SurfacePoint};
use splat_tree::SplatTree;
pub use square_visibility::SquareOccluders;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// Finds what a ray hits.
///
/// * Watertight: no ray passes between triangles that share an edge or a corner (the same f64 positions).
/// * Deterministic: a hit depends on the ray and the scene alone. Of two triangles at equal t, the one with
///   the lower index is hit.
/// * Triangles without area, or with corners that are not finite, are never hit; rays whose direction is zero
///   or not finite hit nothing.
/// * The eye's rays pass through the backs of faces that are not double sided ([`scene::Scene::culls_back_face`]); both sides of
///   every face stop light. [`Self::first_hit`], [`Self::any_hit`], [`Self::is_hidden_from`] and
///   [`Self::square_visibility`] follow the eye, [`Self::is_occluded`] follows light.
/// * Gaussian splats are not hit, except by [`Self::visible_surface`]: they stop no light and cast no shadow.
/// * Transparent points are not hit (see [`scene::AlphaMode`]): under a mask a point exists where the opacity reaches the
///   cutoff; under blending it is hit *by a given ray* with the probability of its opacity, decided by a hash of the ray
///   and the triangle, so that sums over many rays have the right transmittance and each ray gives the same result every
///   time. Queries for many rays at once ([`Self::first_hits`], [`Self::all_hits`], [`Self::square_visibility`]) hit it with
///   every ray; the caller applies the opacity.
pub struct Tracer {
    scene: Arc<Scene>,
    space: LocalSpace,
    hierarchy: Hierarchy,
    /// In the order of the hierarchy's leaves.
    triangles: Vec<LeafTriangle>,
    /// Of the same.
    outlines: Vec<Outline>,
    has_transparency: bool,
    /// Made when it is first needed.
    splat_tree: OnceLock<SplatTree>,
}

/// A triangle prepared for the inner loop.
struct LeafTriangle {
    corners: [DVec3; 3],
    index: u32,
    may_be_transparent: bool,
    culls_back: bool,
}

/// The nearest hit so far.
#[derive(Clone, Copy)]
struct Nearest {
    hit: Option<Hit>,
    /// Nothing at or behind this counts any more.
    t_max: f64,
}

impl Tracer {
    /// Builds the bounding volume hierarchy of the scene's triangles; those without area are never hit.
    pub fn new(scene: Arc<Scene>) -> Self {
        let with_area: Vec<u32> =
            scene.surface_triangles().filter(|&index| has_area(&scene.corners(index))).collect();
        let corners = with_area.iter().flat_map(|&index| scene.corners(index));
        let (low, high) =
            corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        let space = if with_area.is_empty() {
            LocalSpace::enclosing(DVec3::ZERO, DVec3::ZERO)
        } else {
            LocalSpace::enclosing(low, high)
        };
        let boxes: Vec<_> = with_area.iter().map(|&index| space.bounds(&scene.corners(index))).collect();
        let (hierarchy, order) = Hierarchy::build(&boxes);
        let triangles: Vec<_> = order
            .into_iter()
            .map(|place| {
                let index = with_area[place as usize];
                let may_be_transparent = scene.material_of(index).may_be_transparent();
                let culls_back = scene.culls_back_face(index);
                LeafTriangle { corners: scene.corners(index), index, may_be_transparent, culls_back }
            })
            .collect();
        let outlines = triangles.iter().map(|triangle| Outline::new(&triangle.corners, &space)).collect();
        let has_transparency = scene.materials.iter().any(|material| material.alpha == AlphaMode::Blend);
        let splat_tree = OnceLock::new();
        Self { scene, space, hierarchy, triangles, outlines, has_transparency, splat_tree }
    }

    /// The scene in which rays are traced.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Whether any surface may be partly transparent.
    pub fn has_transparency(&self) -> bool {
        self.has_transparency
    }

    /// Bytes that the hierarchy and its triangles take, the scene itself not counted.
    pub fn bytes(&self) -> usize {
        self.hierarchy.bytes()
            + size_of_val(self.triangles.as_slice())
            + size_of_val(self.outlines.as_slice())
    }

    /// The first surface that is visible along a ray from its origin; partly transparent ones are hit at random, by
    /// their opacity. `None` if nothing is.
    pub fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        self.first_hit_with(ray, TransparencyMode::Stochastic)
    }

    /// The same, but partly transparent surfaces are always hit.
    fn first_fractional_hit(&self, ray: &Ray) -> Option<Hit> {
        self.first_hit_with(ray, TransparencyMode::Fractional)
    }

    #[inline(always)]
    fn first_hit_with(&self, ray: &Ray, mode: TransparencyMode) -> Option<Hit> {
        let local = self.space.ray(ray)?;
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        let mut nearest = Nearest { hit: None, t_max: ray.t_max };
        with_widest_simd(
            #[inline(always)]
            || {
                self.hierarchy.walk(
                    &local,
                    local.local_t(ray.t_max),
                    #[inline(always)]
                    |leaf| {
                        self.visit_crossed(
                            leaf,
                            &sheared,
                            #[inline(always)]
                            |triangle, crossing| {
                                if crossing.from_front || !triangle.culls_back {
                                    self.accept_crossing(&mut nearest, triangle, ray, crossing, mode);
                                }
                                true
                            },
                        );
                        Some(local.local_t(nearest.t_max))
                    },
                );
            },
        );
        nearest.hit
    }

    /// The first surface that a ray from a surface point hits, from either side. Free of self-intersection like
    /// [`Self::is_occluded`].
    pub fn first_hit_from(&self, from: SurfacePoint, direction: DVec3) -> Option<Hit> {
        let origin = from.position(&self.scene);
        let ray = Ray { origin, direction, t_min: 0.0, t_max: f64::INFINITY, skip: Some(from.triangle) };
        let local = self.space.ray(&ray)?;
        let sheared = ShearedRay::new(origin, direction);
        let mut nearest = Nearest { hit: None, t_max: ray.t_max };
        with_widest_simd(
            #[inline(always)]
            || {
                self.hierarchy.walk(
                    &local,
                    local.local_t(ray.t_max),
                    #[inline(always)]
                    |leaf| {
                        self.visit_crossed(
                            leaf,
                            &sheared,
                            #[inline(always)]
                            |triangle, crossing| {
                                if !in_plane(&triangle.corners, origin) {
                                    let mode = TransparencyMode::Stochastic;
                                    self.accept_crossing(&mut nearest, triangle, &ray, crossing, mode);
                                }
                                true
                            },
                        );
                        Some(local.local_t(nearest.t_max))
                    },
                );
            },
        );
        nearest.hit
    }

    /// Whether a ray from a surface point hits anything, from either side. Free of self-intersection like
    /// [`Self::is_occluded`].
    pub fn any_hit_from(&self, from: SurfacePoint, direction: DVec3) -> bool {
        let origin = from.position(&self.scene);
        let ray = Ray { origin, direction, t_min: 0.0, t_max: f64::INFINITY, skip: Some(from.triangle) };
        self.any_hit_where(&ray, |triangle, _| !in_plane(&triangle.corners, origin))
    }

    /// Visits each triangle of a leaf that the line of a ray crosses; ends where `visit` returns `false`.
    #[inline(always)]
    fn visit_crossed(
        &self,
        leaf: Range<usize>,
        sheared: &ShearedRay,
        mut visit: impl FnMut(&LeafTriangle, &Crossing) -> bool,
    ) {
        for triangles in self.triangles[leaf].chunks(ShearedRay::AT_ONCE) {
            let last = triangles.len() - 1;
            let corners = |k: usize| &triangles[k.min(last)].corners;
            let corners = [corners(0), corners(1), corners(2), corners(3)];
            let mut near = sheared.may_cross(corners) & (0b1111 >> (3 - last));
            while near != 0 {
                let triangle = &triangles[near.trailing_zeros() as usize & 3];
                near &= near - 1;
                if let Some(crossing) = sheared.cross(&triangle.corners)
                    && !visit(triangle, &crossing)
                {
                    return;
                }
            }
        }
    }

    /// Records a triangle as the nearest visible hit, if it is.
    #[inline(always)]
    fn accept_triangle(
        &self,
        nearest: &mut Nearest,
        triangle: &LeafTriangle,
        ray: &Ray,
        sheared: &ShearedRay,
        mode: TransparencyMode,
    ) -> bool {
        let Some(crossing) = sheared.cross(&triangle.corners) else { return false };
        (crossing.from_front || !triangle.culls_back)
            && self.accept_crossing(nearest, triangle, ray, &crossing, mode)
    }

    /// Records a triangle as the nearest hit, if it is.
    #[inline(always)]
    fn accept_crossing(
        &self,
        nearest: &mut Nearest,
        triangle: &LeafTriangle,
        ray: &Ray,
        crossing: &Crossing,
        mode: TransparencyMode,
    ) -> bool {
        let t = crossing.t;
        let is_nearer = t < nearest.t_max
            || nearest.hit.is_some_and(|hit| t == hit.t && triangle.index < hit.point.triangle);
        if !(t > ray.t_min && is_nearer) || ray.skip == Some(triangle.index) {
            return false;
        }
        let point = SurfacePoint { triangle: triangle.index, barycentric: crossing.barycentric };
        let is_hit = !triangle.may_be_transparent || mode.is_hit(&self.scene, point, ray);
        if is_hit {
            *nearest = Nearest { hit: Some(Hit { point, t }), t_max: t };
        }
        is_hit
    }

    /// Whether any surface lies strictly between a surface point and the world position `source`.
    ///
    /// Free of self-intersection without an offset: the point's own triangle never occludes it, and neither
    /// does any triangle in whose plane the point or `source` lies to the precision of f64 (some 3e-15 of the
    /// coordinates), because a line that starts in a plane does not meet it again. So neighbours that meet at
    /// the point's edge do not occlude it however they are bent, and shells closer together than any fixed
    /// offset still occlude each other. `source` may itself be on a surface.
    pub fn is_occluded(&self, from: SurfacePoint, source: DVec3) -> bool {
        self.any_between(from, source, |_, _| true)
    }

    /// Whether a surface point is invisible from this world position: because of a surface in between ([`Self::is_occluded`],
    /// except for faces whose culled back is turned to the eye), or because the point's own face is seen from its culled back.
    pub fn is_hidden_from(&self, from: SurfacePoint, eye: DVec3) -> bool {
        let shows_back =
            || self.scene.area_normal(from.triangle).dot(eye - from.position(&self.scene)) <= 0.0;
        self.scene.culls_back_face(from.triangle) && shows_back()
            // The ray leads to the eye, which sees the other side of the faces that it hits.
            || self.any_between(from, eye, |triangle, crossing| !triangle.culls_back || !crossing.from_front)
    }

    /// Whether anything that `counts` lies strictly between a surface point and a world position.
    #[inline(always)]
    fn any_between(
        &self,
        from: SurfacePoint,
        to: DVec3,
        counts: impl Fn(&LeafTriangle, &Crossing) -> bool,
    ) -> bool {
        let origin = from.position(&self.scene);
        let ray = Ray { origin, direction: to - origin, t_min: 0.0, t_max: 1.0, skip: Some(from.triangle) };
        self.any_hit_where(&ray, |triangle, crossing| {
            counts(triangle, crossing)
                && !in_plane(&triangle.corners, origin)
                && !in_plane(&triangle.corners, to)
        })
    }

    /// Whether any surface is visible along a ray from its origin; faster than [`Self::first_hit`].
    pub fn any_hit(&self, ray: &Ray) -> bool {
        self.any_hit_where(ray, |triangle, crossing| !triangle.culls_back || crossing.from_front)
    }

    /// Whether a ray hits any triangle that `counts`.
    #[inline(always)]
    fn any_hit_where(&self, ray: &Ray, counts: impl Fn(&LeafTriangle, &Crossing) -> bool) -> bool {
        let Some(local) = self.space.ray(ray) else { return false };
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        let far = local.local_t(ray.t_max);
        let mut has_hit = false;
        with_widest_simd(
            #[inline(always)]
            || {
                self.hierarchy.walk(
                    &local,
                    far,
                    #[inline(always)]
                    |leaf| {
                        self.visit_crossed(
                            leaf,
                            &sheared,
                            #[inline(always)]
                            |triangle, crossing| {
                                let within = crossing.t > ray.t_min && crossing.t < ray.t_max;
                                if !within || ray.skip == Some(triangle.index) || !counts(triangle, crossing)
                                {
                                    return true;
                                }
                                let point = SurfacePoint {
                                    triangle: triangle.index,
                                    barycentric: crossing.barycentric,
                                };
                                has_hit = !triangle.may_be_transparent
                                    || TransparencyMode::Stochastic.is_hit(&self.scene, point, ray);
                                !has_hit
                            },
                        );
                        if has_hit { None } else { Some(far) }
                    },
                );
            },
        );
        has_hit
    }
}

#[cfg(test)]
mod tests;
