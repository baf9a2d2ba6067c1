//! The rays of a patch: the light that they find, and where they end at surfaces whose light is cached.

use super::Transport;
use super::irradiance_lookup::IrradianceLookup;
use super::patch_gathering::{IndirectRay, PatchRayLink, Receiver};
use crate::irradiance::gathered::{IndirectLight, PatchGatherer};
use crate::irradiance::patches::{Patch, Patches};
use crate::irradiance::solved::SolvedPatches;
use crate::path_random::PathRandom;
use glam::{DVec3, Vec3};
use scene::Scene;

/// Where the rays of a patch start.
pub(crate) struct PatchRays {
    receivers: Vec<Receiver>,
    seed: u64,
    rays: u32,
}

/// Light other than that of sampled lights that the rays of a patch found, as irradiance/π.
pub(crate) struct IndirectRays {
    /// Without that of the links.
    pub light: Vec3,
    /// Ends at cached surfaces; their absolute weights sum to at most the mean albedo along the rays, channel by channel.
    pub links: Vec<PatchRayLink>,
    /// Harmonic mean of the hit distances, infinite in the open.
    pub distance: f64,
}

impl PatchRays {
    /// Prepares `rays` rays of a patch.
    pub fn new(transport: &Transport, patches: &Patches, patch: &Patch, rays: u32) -> Self {
        let points = patches.points(patch);
        let receivers = points.iter().take(rays as usize).map(|&point| transport.receiver(point)).collect();
        Self { receivers, seed: PathRandom::seed(points[0].point, patch.normal), rays }
    }

    /// Irradiance/π from sampled lights.
    pub fn direct(&self, transport: &Transport) -> Vec3 {
        let random = |ray| PathRandom::new(!self.seed, ray);
        let arriving = |ray| transport.arriving_direct(self.receiver(ray), random(ray));
        (0..self.rays).map(arriving).sum::<Vec3>() / self.rays as f32
    }

    /// All other light; `lookup` says where the rays end.
    pub fn indirect(&self, transport: &Transport, lookup: IrradianceLookup<'_>) -> IndirectRays {
        let share = 1.0 / self.rays as f32;
        let (mut sum, mut links) = (Vec3::ZERO, Vec::new());
        let (mut nearness, mut albedo_sum) = (0.0, DVec3::ZERO);
        for ray in 0..self.rays {
            let random = PathRandom::new(self.seed, ray);
            let IndirectRay { light, distance, link } =
                transport.arriving_indirect(self.receiver(ray), random, lookup);
            sum += light * share;
            nearness += 1.0 / distance;
            if let Some(link) = link {
                albedo_sum += link.albedo;
                links.push(PatchRayLink { weight: link.weight * share, ..link });
            }
        }
        bound_row_sum(&mut links, albedo_sum / f64::from(self.rays));
        IndirectRays { light: sum, links, distance: f64::from(self.rays) / nearness }
    }

    fn receiver(&self, ray: u32) -> &Receiver {
        &self.receivers[ray as usize % self.receivers.len()]
    }
}

impl PatchGatherer for Transport {
    fn scene(&self) -> &Scene {
        self.scene()
    }

    fn bounces(&self) -> Option<u32> {
        self.world().bounces
    }

    fn direct_light(&self, patches: &Patches, patch: &Patch, rays: u32) -> Vec3 {
        PatchRays::new(self, patches, patch, rays).direct(self)
    }

    fn indirect_light(
        &self,
        solved: &SolvedPatches,
        patches: &Patches,
        patch: &Patch,
        rays: u32,
    ) -> IndirectLight {
        let rays =
            PatchRays::new(self, patches, patch, rays).indirect(self, IrradianceLookup::Solved(solved));
        let linked: Vec3 = rays.links.iter().map(|link| link.weight * link.irradiance).sum();
        let can_bounce = self.world().bounces != Some(0);
        let light = if can_bounce { rays.light + linked } else { rays.light };
        IndirectLight { light, distance: rays.distance as f32 }
    }
}

/// Scales the weights of a patch's links, channel by channel, so that they sum to at most `albedo`.
fn bound_row_sum(links: &mut [PatchRayLink], albedo: DVec3) {
    let sum = row_sum(links);
    // The margin is for the rounding of the scaled weights.
    let scale = albedo / sum * (1.0 - f64::from(f32::EPSILON));
    if scale.cmplt(DVec3::ONE).any() {
        for link in links {
            link.weight = (link.weight.as_dvec3() * scale.min(DVec3::ONE)).as_vec3();
        }
    }
}

/// Sum of the absolute weights of a patch's links.
fn row_sum(links: &[PatchRayLink]) -> DVec3 {
    links.iter().map(|link| link.weight.abs().as_dvec3()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TransportOptions;
    use rayon::prelude::*;
    use scene::{Material, Scalar, Workflow, World};
    use std::sync::Arc;
    use test_scenes::{Mesh, scene_of};
    use trace::Tracer;

    /// A cube that rests on a slab, with a ball in the corner between them, of rough metal that is white in red and
    /// darker in green and blue.
    fn metal_shapes() -> Arc<Scene> {
        let metal = || Material {
            base_color: Vec3::new(1.0, 0.9, 0.3).extend(1.0),
            workflow: Workflow::MetallicRoughness {
                metallic: Scalar::constant(1.0),
                roughness: Scalar::constant(1.0),
            },
            ..Material::default()
        };
        let slab = Mesh::cuboid(DVec3::new(-1.0, -0.1, -1.0), DVec3::new(1.0, 0.0, 1.0));
        let cube = Mesh::cuboid(DVec3::ZERO, DVec3::splat(0.6));
        let ball = Mesh::sphere(DVec3::new(-0.1, 0.1, 0.3), 0.1, 12);
        scene_of([(slab, metal()), (cube, metal()), (ball, metal())])
    }

    #[test]
    fn no_patch_sends_on_more_than_arrives() {
        let scene = metal_shapes();
        let transport = Transport::new(
            Arc::new(Tracer::new(scene.clone())),
            World::studio(),
            TransportOptions::default(),
        );
        let patches = Patches::new(&scene, 600);
        let lookup = IrradianceLookup::Unsolved(&patches);
        let rows: Vec<DVec3> = patches
            .all()
            .par_iter()
            .map(|patch| {
                row_sum(&PatchRays::new(&transport, &patches, patch, 96).indirect(&transport, lookup).links)
            })
            .collect();
        let largest = rows.iter().copied().fold(DVec3::ZERO, DVec3::max);
        assert!(largest.cmple(DVec3::ONE).all(), "{largest}");
        assert!(largest.x > 0.5, "some patches receive light from others alone: {largest}");
    }

    #[test]
    fn a_row_is_scaled_to_its_bound_channel_by_channel() {
        let scene = metal_shapes();
        let place = crate::irradiance::place::Place::new(
            &scene,
            scene::SurfacePoint { triangle: 0, barycentric: glam::DVec2::splat(0.3) },
            true,
        );
        let link =
            |weight| PatchRayLink { place, irradiance: Vec3::ZERO, weight, albedo: DVec3::ONE, choice: 0.5 };
        let links = || vec![link(Vec3::new(0.9, 0.2, 0.0)), link(Vec3::new(0.9, 0.1, 0.0))];
        let mut bounded = links();
        bound_row_sum(&mut bounded, DVec3::new(1.2, 0.5, 0.0));
        let sum = row_sum(&bounded);
        assert!(sum.x <= 1.2 && sum.x > 1.2 - 1e-6, "{sum}");
        assert!((sum.y - 0.3).abs() < 1e-7 && sum.z == 0.0, "what is below its bound stays: {sum}");
        let mut empty = Vec::new();
        bound_row_sum(&mut empty, DVec3::ZERO);
        assert!(empty.is_empty());
    }
}
