//! Tracing of a path from surface to surface, until its light is cached.

use super::irradiance_lookup::{Arrival, CachedPlace, IrradianceLookup};
use super::{Path, Step, Transport, power_heuristic};
use crate::bounce_limit::MAX_BOUNCES;
use crate::material_point::{MaterialPoint, emitted};
use glam::DVec3;
use material::{Bsdf, Split};
use trace::Hit;

/// Light found by a path.
pub(super) struct PathLight {
    /// Light directly from sources that are also sampled as lights.
    pub direct: DVec3,
    /// All other light.
    pub indirect: DVec3,
    /// Distance to the first surface, infinite if there is none.
    pub distance: f64,
    /// Where the path ended at cached irradiance, and the share of it that is passed on.
    pub cached_end: Option<(CachedPlace, DVec3)>,
    /// The product of the albedos of the surfaces that a bounded path met, and of what refraction does to radiance.
    pub albedo: DVec3,
}

/// Throughput of a path that may be cut off without a word.
const NEGLIGIBLE_THROUGHPUT: f64 = 0.01;
/// Number of scattering events before Russian roulette starts.
const MIN_SCATTERINGS: u32 = 3;
/// Share of paths that go on past the cache when it is a control variate. Fewer cost less but add noise: measured in
/// rooms with grey and with white walls, an eighth takes up to twice the time for the same error, a half as much as
/// all.
const CHECKED_SHARE: f64 = 1.0 / 2.0;

impl Transport {
    /// Traces a path from its first step on, up to where its light is cached.
    pub(super) fn trace_path(
        &self,
        mut step: Step,
        path: &mut Path,
        mut lookup: IrradianceLookup<'_>,
    ) -> PathLight {
        let scene = self.scene();
        let max_bounces = self.world.bounces.unwrap_or(MAX_BOUNCES);
        let mut result = PathLight {
            direct: DVec3::ZERO,
            indirect: DVec3::ZERO,
            distance: f64::INFINITY,
            cached_end: None,
            albedo: DVec3::ONE,
        };
        let mut throughput = DVec3::ONE;
        let mut min_density = step.density;
        for scatterings in 1u32.. {
            let hit = self.tracer.first_hit_from(step.origin, step.direction);
            let length = hit.map_or(f64::INFINITY, |hit| hit.t);
            throughput *= self.media.attenuation(&path.inside, length);
            let Some(Hit { point, t }) = hit else {
                let (radiance, light_density) = self.lights.environment_along(&self.world, step.direction);
                let light = throughput * radiance.as_dvec3();
                let draws_per_direction = path.lights.sky;
                result.add(light, step.density, [light_density, draws_per_direction], scatterings);
                return result;
            };
            if scatterings == 1 {
                result.distance = t;
            }
            let outgoing = -step.direction;
            let emission = emitted(scene, point, outgoing).as_dvec3();
            if emission != DVec3::ZERO {
                let place = point.position(scene);
                let light_density = self.lights.emitter_density(point.triangle, place, step.position);
                let draws_per_direction = path.lights.emitters;
                result.add(
                    throughput * emission,
                    step.density,
                    [light_density, draws_per_direction],
                    scatterings,
                );
            }
            if scene.material_of(point.triangle).unlit {
                return result;
            }
            if scatterings > max_bounces {
                if self.world.bounces.is_none() && throughput.max_element() > NEGLIGIBLE_THROUGHPUT {
                    self.bounce_limit.reach();
                }
                return result;
            }
            let mut at = MaterialPoint::new(scene, point, self.options.scattering);
            if let (IrradianceLookup::Trusted(_), Some(density)) = (lookup, min_density) {
                at.surface = at.surface.no_sharper_than(regularized_roughness(density));
            }
            throughput *= self.disperse(&at, path);
            let is_front = at.frame.geometric.dot(outgoing) >= 0.0;
            let interface = self.media.interface(at.material, &path.inside, is_front);
            let bsdf = Bsdf::new(&at.surface, at.frame, interface);
            let lobes = bsdf.toward(outgoing);
            let arrival = Arrival { distance: t, scatterings, density: min_density };
            let scattered = match lookup.cached_place(self, (point, is_front), arrival) {
                None => {
                    result.indirect += throughput * self.direct(point, &at, &lobes, path).total();
                    let Some(scattered) = lobes.resample(|| path.random.next()) else { return result };
                    if lookup.is_bounded() {
                        // No product of albedos exceeds 1 in a medium, whereas a product of sampled weights has no
                        // bound.
                        let albedo = lobes.albedo().total() * lobes.radiance_scale(scattered.crosses);
                        result.albedo *= albedo;
                        throughput *= albedo;
                    } else {
                        throughput *= scattered.weight.total();
                    }
                    scattered
                }
                Some(cached) => {
                    // The own part ends at the cache; the carried part is traced on.
                    let Split { own, carried } = lobes.albedo();
                    result.albedo *= own + carried;
                    let [own_albedo, carried_albedo] = [own, carried].map(DVec3::element_sum);
                    if carried_albedo > 0.0 {
                        result.indirect += throughput * self.direct_carried(point, &at, &lobes, path);
                    }
                    let end_probability = own_albedo / (own_albedo + carried_albedo);
                    if carried_albedo == 0.0 || path.random.next() < end_probability {
                        if carried_albedo > 0.0 {
                            throughput /= end_probability;
                        }
                        let is_checked = lookup.is_control_variate() && path.random.next() < CHECKED_SHARE;
                        let cached_share = if is_checked { 1.0 - 1.0 / CHECKED_SHARE } else { 1.0 };
                        result.cached_end =
                            (own_albedo > 0.0).then_some((cached, throughput * own * cached_share));
                        if own_albedo == 0.0 || !lookup.is_control_variate() {
                            return result;
                        }
                        result.indirect += throughput * self.direct(point, &at, &lobes, path).own;
                        if !is_checked {
                            return result;
                        }
                        (lookup, throughput) = (IrradianceLookup::Unavailable, throughput / CHECKED_SHARE);
                        let Some(scattered) = lobes.sample(path.random.next3()) else { return result };
                        throughput *= scattered.weight.own;
                        scattered
                    } else {
                        let Some(scattered) = lobes.sample_sharp(path.random.next3()) else { return result };
                        throughput *= scattered.weight.carried / (1.0 - end_probability);
                        result.albedo *= lobes.radiance_scale(scattered.crosses);
                        scattered
                    }
                }
            };
            if scatterings >= MIN_SCATTERINGS || throughput == DVec3::ZERO {
                // A path that loses no light goes on: one that ended by chance would leave its light to the others,
                // whose weights would grow without bound between white surfaces.
                let survival_probability = (throughput.max_element() / lookup.roulette_throughput()).min(1.0);
                if path.random.next() >= survival_probability {
                    return result;
                }
                throughput /= survival_probability;
            }
            step = self.step(point, &at, &scattered, path);
            min_density = match (min_density, step.density) {
                (Some(so_far), Some(density)) => Some(so_far.min(density)),
                (so_far, density) => so_far.or(density),
            };
        }
        result
    }
}

impl PathLight {
    /// Light passed on from cached irradiance, linear RGB; black if the path does not end on it.
    pub fn cached_light(&self) -> DVec3 {
        self.cached_end.as_ref().map_or(DVec3::ZERO, |(cached, share)| *share * cached.irradiance.as_dvec3())
    }

    /// Adds light found after a number of scattering events by a direction of some density, weighted against light
    /// sampling: its density, and how many light samples were taken per first direction.
    fn add(
        &mut self,
        light: DVec3,
        density: Option<f64>,
        [light_density, draws_per_direction]: [f64; 2],
        scatterings: u32,
    ) {
        let expected_draws =
            if scatterings == 1 { light_density * draws_per_direction } else { light_density };
        let light = light * density.map_or(1.0, |own| power_heuristic(own, expected_draws));
        let sum = if scatterings == 1 && light_density > 0.0 { &mut self.direct } else { &mut self.indirect };
        *sum += light;
    }
}

/// Perceptual roughness that a surface may be raised to when seen through a lobe whose sampled direction had this
/// density, 1/sr. An emitter mirrored in rough metal is then found by light sampling rather than by chance, at the cost
/// of a little blur of what is blurred anyway (path space regularisation, Kaplanyan and Dachsbacher 2013; the widths
/// are those of Cycles).
fn regularized_roughness(density: f64) -> f64 {
    let alpha = 0.5 * (1.0 - density).max(0.0).sqrt();
    alpha.sqrt()
}
