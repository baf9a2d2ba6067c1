//! Solution of the irradiance of all patches, bounce by bounce.
//!
//! Every patch sends cosine-distributed rays once. A ray ends at a light, which counts at once, or at a diffuse
//! surface: a *link* to a patch, with the weight by which its diffuse lobes pass on what arrives there. Gloss and
//! glass on the way are traced as usual. Light is then a linear system, E = D + I₀ + T·E, solved by passing light
//! along the links; each pass is a bounce. No row of T sums to more than the albedos along its rays, whatever the
//! geometry, so a pass never makes light. Finally each patch's indirect light is averaged with its neighbours' as far
//! as no near surface interferes (Ward 1988: the harmonic mean of the hit distances).

use crate::bounce_limit::MAX_BOUNCES;
use crate::irradiance::patches::{Patch, Patches};
use crate::irradiance::place::Place;
use crate::irradiance::{Irradiance, IrradianceSolution};
use crate::transport::{PatchRay, PatchRayLink, Transport};
use glam::{DVec3, Vec3};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::{Scene, World};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Change of a pass, as a share of the brightest patch, at which light has died away.
const CONVERGED_CHANGE: f32 = 1e-5;
/// Neighbours within this share of the harmonic mean distance are averaged.
const SMOOTHING_RADIUS: f64 = 0.25;

/// What the rays of a patch gathered, as irradiance/π.
struct PatchLight {
    direct: Vec3,
    /// Light that did not come directly from a sampled light.
    indirect: Vec3,
    links: Vec<(u32, Vec3)>,
    /// Harmonic mean of the hit distances, infinite in the open.
    distance: f64,
}

/// Resolution of the solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IrradianceOptions {
    /// Approximate number of patches.
    pub patches: u32,
    /// Rays per patch.
    pub rays: u32,
}

impl Default for IrradianceOptions {
    fn default() -> Self {
        Self { patches: 24_000, rays: 96 }
    }
}

impl Irradiance {
    /// Solves for the light of a scene. Deterministic: the same bits for any number of threads.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` asks to stop.
    pub fn solve(
        transport: &Transport,
        options: IrradianceOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let patches = Patches::new(transport.scene(), options.patches);
        let solution = solve_bounces(transport, &patches, options.rays.max(1), progress)?;
        Ok(Self::new(patches, solution, transport.world()))
    }

    /// Restores an irradiance from its [`solution`](Irradiance::solution), of the same scene, world and options; `None`
    /// if the number of values does not match or one is not finite.
    pub fn from_solution(
        scene: &Scene,
        world: &World,
        options: IrradianceOptions,
        solution: IrradianceSolution,
    ) -> Option<Self> {
        let patches = Patches::new(scene, options.patches);
        let fits = |values: &Vec<Vec3>| {
            values.len() == patches.all().len() && values.iter().all(|value| value.is_finite())
        };
        let is_valid = [&solution.direct, &solution.indirect].into_iter().all(fits);
        is_valid.then(|| Self::new(patches, solution, world))
    }
}

/// Direct and indirect irradiance/π of all patches.
fn solve_bounces(
    transport: &Transport,
    patches: &Patches,
    rays: u32,
    progress: &dyn Progress,
) -> Result<IrradianceSolution, Cancelled> {
    let done = AtomicUsize::new(0);
    let all = patches.all();
    let patch_light: Vec<PatchLight> = all
        .par_iter()
        .map(|patch| {
            progress.check()?;
            let light = trace_patch_rays(transport, patches, patch, rays);
            progress.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / all.len() as f32);
            Ok(light)
        })
        .collect::<Result<_, Cancelled>>()?;
    let direct: Vec<Vec3> = patch_light.iter().map(|light| light.direct).collect();
    let mut indirect: Vec<Vec3> = patch_light.iter().map(|light| light.indirect).collect();
    let bounces = transport.world().bounces;
    let mut is_cut_off = bounces.is_none();
    for _ in 0..bounces.map_or(MAX_BOUNCES, |bounces| bounces.min(MAX_BOUNCES)) {
        progress.check()?;
        let next: Vec<Vec3> = patch_light
            .par_iter()
            .map(|light| {
                let sent = |&(patch, weight): &(u32, Vec3)| {
                    weight * (direct[patch as usize] + indirect[patch as usize])
                };
                light.indirect + light.links.iter().map(sent).sum::<Vec3>()
            })
            .collect();
        let change =
            next.iter().zip(&indirect).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max);
        let brightest = next.iter().map(|light| light.max_element()).fold(0.0, f32::max);
        indirect = next;
        if change <= CONVERGED_CHANGE * brightest {
            is_cut_off = false;
            break;
        }
    }
    let indirect = (0..all.len())
        .into_par_iter()
        .map(|at| smoothed_indirect(patches, &patch_light, &indirect, at))
        .collect();
    Ok(IrradianceSolution { direct, indirect, is_cut_off })
}

/// Traces the rays of a patch.
fn trace_patch_rays(transport: &Transport, patches: &Patches, patch: &Patch, rays: u32) -> PatchLight {
    let points = patches.points(patch);
    let share = 1.0 / rays as f32;
    let (mut direct, mut indirect, mut links) = (Vec3::ZERO, Vec3::ZERO, Vec::new());
    let (mut nearness, mut albedo_sum) = (0.0, DVec3::ZERO);
    for ray in 0..rays {
        let point = points[ray as usize % points.len()];
        let PatchRay { direct: drawn, indirect: other, distance, link: onward } =
            transport.trace_patch_ray(points[0].point, point, ray, patches);
        direct += drawn * share;
        indirect += other * share;
        nearness += 1.0 / distance;
        if let Some(PatchRayLink { place, weight, albedo, choice }) = onward
            && let Some(target) = choose_patch(patches, &place, choice)
        {
            links.push((target, weight * share));
            albedo_sum += albedo;
        }
    }
    bound_row_sum(&mut links, albedo_sum / f64::from(rays));
    PatchLight { direct, indirect, links, distance: f64::from(rays) / nearness }
}

/// Scales the weights of a patch's links, channel by channel, so that they sum to at most `albedo`.
fn bound_row_sum(links: &mut [(u32, Vec3)], albedo: DVec3) {
    let sum = row_sum(links);
    // The margin is for the rounding of the scaled weights.
    let scale = albedo / sum * (1.0 - f64::from(f32::EPSILON));
    if scale.cmplt(DVec3::ONE).any() {
        links
            .iter_mut()
            .for_each(|(_, weight)| *weight = (weight.as_dvec3() * scale.min(DVec3::ONE)).as_vec3());
    }
}

/// Sum of the absolute weights of a patch's links.
fn row_sum(links: &[(u32, Vec3)]) -> DVec3 {
    links.iter().map(|(_, weight)| weight.abs().as_dvec3()).sum()
}

/// Samples a patch around a place by its interpolation weight.
fn choose_patch(patches: &Patches, place: &Place, choice: f64) -> Option<u32> {
    let around = patches.around(place);
    let sum: f32 = around.clone().map(|(_, weight)| weight).sum();
    let mut rest = choice as f32 * sum;
    let mut chosen = None;
    for (patch, weight) in around {
        if rest >= 0.0 {
            chosen = Some(patch);
        }
        rest -= weight;
    }
    chosen
}

/// The indirect light of a patch, averaged with its neighbours'.
fn smoothed_indirect(patches: &Patches, patch_light: &[PatchLight], indirect: &[Vec3], at: usize) -> Vec3 {
    let patch = &patches.all()[at];
    let (mut sum, mut weights) = (indirect[at] * patch.area as f32, patch.area as f32);
    patches.visit_neighbors(patch, |other| {
        let other = other as usize;
        if other == at {
            return;
        }
        let neighbor = &patches.all()[other];
        let reach = SMOOTHING_RADIUS * patch_light[at].distance.min(patch_light[other].distance);
        let near = (1.0 - patch.position.distance(neighbor.position) / reach).max(0.0);
        let weight = (near * neighbor.area) as f32;
        sum += indirect[other] * weight;
        weights += weight;
    });
    sum / weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TransportOptions;
    use progress::Unwatched;
    use scene::{Material, Scalar, Workflow};
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
        let rows: Vec<DVec3> = patches
            .all()
            .par_iter()
            .map(|patch| row_sum(&trace_patch_rays(&transport, &patches, patch, 96).links))
            .collect();
        let largest = rows.iter().copied().fold(DVec3::ZERO, DVec3::max);
        assert!(largest.cmple(DVec3::ONE).all(), "{largest}");
        assert!(largest.x > 0.5, "some patches receive light from others alone: {largest}");
    }

    #[test]
    fn a_row_is_scaled_to_its_bound_channel_by_channel() {
        let links = || vec![(0, Vec3::new(0.9, 0.2, 0.0)), (1, Vec3::new(0.9, 0.1, 0.0))];
        let mut bounded = links();
        bound_row_sum(&mut bounded, DVec3::new(1.2, 0.5, 0.0));
        let sum = row_sum(&bounded);
        assert!(sum.x <= 1.2 && sum.x > 1.2 - 1e-6, "{sum}");
        assert!((sum.y - 0.3).abs() < 1e-7 && sum.z == 0.0, "what is below its bound stays: {sum}");
        let mut empty = Vec::new();
        bound_row_sum(&mut empty, DVec3::ZERO);
        assert!(empty.is_empty());
    }

    #[test]
    fn light_in_a_closed_room_is_its_series_sum_or_cut_off() {
        let room = Mesh::cuboid(DVec3::ZERO, DVec3::new(2.0, 1.0, 1.5)).turned();
        let solve = |albedo: f32| {
            let wall = Material {
                base_color: Vec3::splat(albedo).extend(1.0),
                emissive: Vec3::splat(1.0 - albedo + 0.001),
                ..Material::lambertian_white()
            };
            let tracer = Arc::new(Tracer::new(scene_of([(&room, wall)])));
            let transport = Transport::new(tracer, World::uniform(Vec3::ZERO), TransportOptions::default());
            let options = IrradianceOptions { patches: 200, rays: 64 };
            Irradiance::solve(&transport, options, &Unwatched).unwrap()
        };
        let mean = |irradiance: &Irradiance| {
            let solution = irradiance.solution();
            let all = solution.direct.iter().zip(&solution.indirect).map(|(a, b)| f64::from(a.x + b.x));
            all.sum::<f64>() / solution.direct.len() as f64
        };
        let converged = solve(0.99);
        assert!(!converged.solution().is_cut_off);
        // Every point receives what every other sends: Le/(1 − ρ).
        assert!((mean(&converged) / (0.011 / 0.01) - 1.0).abs() < 0.02, "{}", mean(&converged));
        let endless = solve(1.0);
        assert!(endless.solution().is_cut_off);
        assert!(mean(&endless).is_finite());
    }
}
