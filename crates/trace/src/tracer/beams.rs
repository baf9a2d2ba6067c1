//! Hits of the rays of a beam.

use super::{LeafTriangle, Nearest, Tracer};
use crate::transparency::TransparencyMode;
use crate::watertight::{ShearedRay, ShearedRayPacket};
use crate::{Beam, Hit, Ray};
use glam::DVec3;
use numerics::with_widest_simd;
use std::ops::Range;

/// Rays of a beam, prepared for the test of many triangles.
struct RayPacket<'a> {
    rays: &'a [Ray],
    sheared: [ShearedRay; Beam::MAX_RAYS],
    sheared_packet: ShearedRayPacket,
}

impl<'a> RayPacket<'a> {
    /// `None` for rays that have to be traced one by one.
    fn new(rays: &'a [Ray]) -> Option<Self> {
        assert!(rays.len() <= Beam::MAX_RAYS, "more rays than a beam has");
        let is_usable = |ray: &Ray| ray.direction.is_finite() && ray.direction != DVec3::ZERO;
        if rays.is_empty() || !rays.iter().all(is_usable) {
            return None;
        }
        let sheared = std::array::from_fn(|at| {
            let ray = &rays[at.min(rays.len() - 1)];
            ShearedRay::new(ray.origin, ray.direction)
        });
        let sheared_packet = ShearedRayPacket::new(&sheared)?;
        Some(Self { rays, sheared, sheared_packet })
    }

    /// The ray at an index; the last one beyond the end.
    fn ray(&self, at: usize) -> &Ray {
        &self.rays[at.min(self.rays.len() - 1)]
    }

    /// Calls `visit` with each ray that may hit a triangle.
    #[inline(always)]
    fn visit_near_rays(&self, triangle: &LeafTriangle, mut visit: impl FnMut(usize, &Ray, &ShearedRay)) {
        let mut near = self.sheared_packet.may_hit(&triangle.corners) & (u32::MAX >> (32 - self.rays.len()));
        while near != 0 {
            let at = near.trailing_zeros() as usize;
            near &= near - 1;
            visit(at, &self.rays[at], &self.sheared[at]);
        }
    }
}

impl Tracer {
    /// The first hit of each ray of a beam: the same as [`Self::first_hit`] at a lower cost, except that partly transparent
    /// surfaces are hit by all rays. At most
    /// [`Beam::MAX_RAYS`] rays; all start at the beam's origin and lie between its edges.
    pub fn first_hits(&self, beam: &Beam, rays: &[Ray]) -> [Option<Hit>; Beam::MAX_RAYS] {
        let Some(packet) = RayPacket::new(rays) else {
            return std::array::from_fn(|at| rays.get(at).and_then(|ray| self.first_fractional_hit(ray)));
        };
        let mut nearest: [_; Beam::MAX_RAYS] =
            std::array::from_fn(|at| Nearest { hit: None, t_max: packet.ray(at).t_max });
        let far = |nearest: &[Nearest]| {
            let farthest =
                nearest[..rays.len()].iter().fold(f64::NEG_INFINITY, |far, ray| far.max(ray.t_max));
            if farthest.is_finite() { beam.height(&self.space, farthest) } else { f32::INFINITY }
        };
        let mut farthest = far(&nearest);
        with_widest_simd(
            #[inline(always)]
            || {
                self.hierarchy.walk_halfspaces(&beam.shaft(&self.space), farthest, &mut |leaf: Range<
                    usize,
                >| {
                    let mut is_changed = false;
                    for triangle in &self.triangles[leaf] {
                        packet.visit_near_rays(
                            triangle,
                            #[inline(always)]
                            |at, ray, sheared| {
                                let mode = TransparencyMode::Fractional;
                                is_changed |=
                                    self.accept_triangle(&mut nearest[at], triangle, ray, sheared, mode);
                            },
                        );
                    }
                    if is_changed {
                        farthest = far(&nearest);
                    }
                    farthest
                });
            },
        );
        nearest.map(|nearest| nearest.hit)
    }

    /// All hits of the rays of a beam, in order, at most `max_hits` per ray: what [`Self::first_hits`] finds for
    /// the ray, for the ray behind that hit, and so on. Pairs of a ray's index and a hit, ray by ray; rays as those of
    /// [`Self::first_hits`].
    pub fn all_hits(&self, beam: &Beam, rays: &[Ray], max_hits: usize) -> Vec<(usize, Hit)> {
        let Some(packet) = RayPacket::new(rays) else { return self.all_hits_per_ray(rays, max_hits) };
        let mut hits: Vec<(usize, Hit)> = Vec::new();
        with_widest_simd(
            #[inline(always)]
            || {
                let shaft = beam.shaft(&self.space);
                self.hierarchy.walk_halfspaces(&shaft, f32::INFINITY, &mut |leaf: Range<usize>| {
                    for triangle in &self.triangles[leaf] {
                        packet.visit_near_rays(
                            triangle,
                            #[inline(always)]
                            |at, ray, sheared| {
                                let mut only = Nearest { hit: None, t_max: ray.t_max };
                                let mode = TransparencyMode::Fractional;
                                self.accept_triangle(&mut only, triangle, ray, sheared, mode);
                                hits.extend(only.hit.map(|hit| (at, hit)));
                            },
                        );
                    }
                    f32::INFINITY
                });
            },
        );
        // Of several hits at one t only the first triangle counts.
        let key = |(at, hit): &(usize, Hit)| (*at, hit.t, hit.point.triangle);
        hits.sort_unstable_by(|a, b| key(a).partial_cmp(&key(b)).expect("t is a number"));
        hits.dedup_by_key(|(at, hit)| (*at, hit.t));
        let (mut last, mut count) = (usize::MAX, 0);
        hits.retain(|(at, _)| {
            count = if *at == last { count + 1 } else { 1 };
            last = *at;
            count <= max_hits
        });
        hits
    }

    #[cold]
    fn all_hits_per_ray(&self, rays: &[Ray], max_hits: usize) -> Vec<(usize, Hit)> {
        let along = |(at, ray): (usize, &Ray)| {
            let mut ray = *ray;
            let next = move || {
                let hit = self.first_fractional_hit(&ray)?;
                ray = Ray { t_min: hit.t, skip: Some(hit.point.triangle), ..ray };
                Some((at, hit))
            };
            std::iter::from_fn(next).take(max_hits)
        };
        rays.iter().enumerate().flat_map(along).collect()
    }
}
