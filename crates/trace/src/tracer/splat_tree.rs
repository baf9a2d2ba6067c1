//! The splats of a scene in a hierarchy.

use crate::hierarchy::Hierarchy;
use crate::local_space::LocalSpace;
use crate::{Hit, Ray};
use gaussians::CloudRay;
use glam::DVec3;
use rayon::prelude::*;
use scene::PlacedCloud;

/// The splats of a scene in a hierarchy of the boxes in which their response counts.
pub(super) struct SplatTree {
    space: LocalSpace,
    hierarchy: Hierarchy,
    /// The splats in the order of the hierarchy's leaves.
    order: Vec<u32>,
}

impl SplatTree {
    pub fn new(splats: &PlacedCloud) -> Self {
        let stretch = splats.placement.scale.max_element();
        let corners = |index: u32| {
            let splat = splats.cloud.splat(index as usize);
            let mean = splats.placement.point(splat.mean.as_dvec3());
            let reach = DVec3::splat(splat.reach() * stretch);
            [mean - reach, mean, mean + reach]
        };
        let count = splats.cloud.len() as u32;
        let (low, high) = (0..count)
            .map(corners)
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), [a, _, b]| (l.min(a), h.max(b)));
        let space = LocalSpace::enclosing(low, high);
        let boxes: Vec<_> = (0..count).into_par_iter().map(|index| space.bounds(&corners(index))).collect();
        let (hierarchy, order) = Hierarchy::build(&boxes);
        Self { space, hierarchy, order }
    }

    /// The surface before the ray's end.
    pub fn surface(&self, splats: &PlacedCloud, ray: &Ray) -> Option<Hit> {
        let local = self.space.ray(ray)?;
        let in_file = CloudRay::new(&splats.placement, ray.origin, ray.direction);
        let (far, mut near) = (local.local_t(ray.t_max), Vec::new());
        self.hierarchy.walk(&local, far, |leaf| {
            near.extend_from_slice(&self.order[leaf]);
            Some(far)
        });
        let hit = in_file.surface(&splats.cloud, near.into_iter())?;
        let is_within = hit.depth > ray.t_min && hit.depth < ray.t_max;
        is_within.then(|| Hit { point: splats.address(hit.splat), t: hit.depth })
    }
}
