//! Solution of the irradiance of patches, bounce by bounce.
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
use crate::irradiance::smoothing::smoothed_indirect;
use crate::irradiance::solved::{IrradianceSolution, SolvedPatches};
use crate::irradiance::{Irradiance, IrradianceOptions};
use crate::transport::Transport;
use crate::transport::irradiance_lookup::IrradianceLookup;
use crate::transport::patch_rays::{IndirectRays, PatchRays};
use glam::Vec3;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Change of a pass, as a share of the brightest patch, at which light has died away.
const CONVERGED_CHANGE: f32 = 1e-5;

/// What the rays of a patch gathered, as irradiance/π.
struct PatchLight {
    direct: Vec3,
    /// Light that did not come directly from a sampled light.
    indirect: Vec3,
    /// Patches whose light is sent on, and the share of it.
    links: Vec<(u32, Vec3)>,
    /// Harmonic mean of the hit distances, infinite in the open.
    distance: f64,
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
        let patches = Patches::new(transport.scene(), options.solved());
        // Smaller patches that gather this light add a bounce.
        let gathering = u32::from(options.solved() < options.patches);
        let limit = transport.world().bounces.map(|bounces| bounces.saturating_sub(gathering));
        let solution = solve_bounces(transport, &patches, options.rays.max(1), limit, progress)?;
        let solved = SolvedPatches { patches, solution };
        Ok(Self::new(solved, options, transport.scene(), transport.world()))
    }
}

/// Direct and indirect irradiance/π of all patches, after at most `bounces` between them.
fn solve_bounces(
    transport: &Transport,
    patches: &Patches,
    rays: u32,
    bounces: Option<u32>,
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
        .map(|at| smoothed_indirect(patches, at, |patch| (indirect[patch], patch_light[patch].distance)))
        .collect();
    Ok(IrradianceSolution { direct, indirect, is_cut_off })
}

/// Traces the rays of a patch.
fn trace_patch_rays(transport: &Transport, patches: &Patches, patch: &Patch, rays: u32) -> PatchLight {
    let rays = PatchRays::new(transport, patches, patch, rays);
    let IndirectRays { light, links, distance } =
        rays.indirect(transport, IrradianceLookup::Unsolved(patches));
    let links = links
        .iter()
        .filter_map(|link| Some((choose_patch(patches, &link.place, link.choice)?, link.weight)))
        .collect();
    PatchLight { direct: rays.direct(transport), indirect: light, links, distance }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TransportOptions;
    use glam::DVec3;
    use progress::Unwatched;
    use scene::{Material, World};
    use std::sync::Arc;
    use test_scenes::{Mesh, scene_of};
    use trace::Tracer;

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
