//! Light that the irradiance cache does not cover: sampled lights and sharp lobes.

use super::batch_measurement::shared_lights;
use super::scattered_light::ScatteredLight;
use super::{IrradianceLookup, LightsPerDirection, Path, Transport, power_heuristic, samples_per_point};
use crate::irradiance::Irradiance;
use crate::material_point::MaterialPoint;
use crate::media::MediumStack;
use crate::path_random::PathRandom;
use glam::DVec3;
use material::{Bsdf, OutgoingBsdf, Parts, Split};
use scene::SurfacePoint;
use std::cell::Cell;
use std::f64::consts::PI;
use trace::SampleSlot;

/// Albedo of the traced lobes from which on the full number of paths is used.
const FULL_PATHS_ALBEDO: f64 = 0.5;

/// Factor on the number of light samples where spread light is not interpolated.
const SPREAD_LIGHTS_FACTOR: u32 = 2;

impl Transport {
    /// Light scattered toward the eye that cached irradiance does not cover: sampled lights, and all light of sharp
    /// lobes.
    pub(super) fn trace_uncached(
        &self,
        point: SurfacePoint,
        at: &MaterialPoint,
        (lobes, outgoing): (&OutgoingBsdf<'_, '_>, DVec3),
        inside: MediumStack,
        (irradiance, slot): (&Irradiance, SampleSlot),
    ) -> ScatteredLight {
        let (Split { own, carried }, spread_albedo) = (lobes.albedo(), lobes.spread_albedo());
        let is_interpolated = slot.incident.is_some();
        let is_gloss_interpolated = slot.incident.is_some_and(|incident| incident.gloss.is_some());
        // Without sharp lobes, paths only search for large emitters; if everything else is interpolated, their number
        // follows the albedo of what they may find.
        let share = match is_interpolated {
            true => {
                let traced_own = if is_gloss_interpolated { DVec3::ZERO } else { own - spread_albedo };
                ((traced_own + carried).max_element() / FULL_PATHS_ALBEDO).min(1.0).powi(2)
            }
            false if lobes.is_spread() => 0.25,
            false => 1.0,
        };
        let scaled = |requested: u32| (f64::from(requested) * share).ceil() as u32;
        let paths = samples_per_point(slot, scaled(self.options.paths));
        let light_count = match is_interpolated {
            true => scaled(self.options.light_samples),
            false => SPREAD_LIGHTS_FACTOR * self.options.light_samples,
        };
        let draws = self.lights.draw_counts(samples_per_point(slot, light_count));
        let lights_per_path = f64::from(draws.total) / f64::from(paths);
        let punctual_weight = f64::from(draws.total) / f64::from(draws.punctual);
        // Within a batch, widely spread light uses the same samples for all points, so its error is the same for all of
        // them.
        let is_batched = slot.count > 1 && !is_gloss_interpolated;
        let light_seed = if is_batched && !is_interpolated { shared_lights::LIGHT_SEED } else { slot.seed };
        let direction_seed =
            if is_batched && carried == DVec3::ZERO { shared_lights::DIRECTION_SEED } else { !slot.seed };
        // The light of an unoccluded sky is known and serves as a control variate: it replaces what the sky's samples
        // would find of it, so the samples only estimate what is occluded. The mean does not change.
        let normal = lobes.normal();
        let unshaded = if is_interpolated { None } else { irradiance.unshaded(&self.world, normal) };
        let sampled_unshaded = Cell::new(DVec3::ZERO);
        let mut direct = Split::default();
        for index in 0..draws.total {
            let random = PathRandom::new(light_seed, slot.index * draws.total + index);
            let mut path = Path { random, inside, lights: LightsPerDirection::uniform(lights_per_path) };
            direct += self.sum_direct(point, at, &mut path, index < draws.punctual, |sample| {
                let (Parts { spread, sharp }, own) = lobes.scatter_parts(sample.direction);
                if sample.density.is_some() && !sample.is_near {
                    let light = sample.light.as_dvec3() * normal.dot(sample.direction).max(0.0);
                    sampled_unshaded.set(sampled_unshaded.get() + light);
                }
                let share = sample
                    .density
                    .map_or(punctual_weight, |density| power_heuristic(density * lights_per_path, own));
                // For spread light only emitters are sampled by two techniques.
                let spread_share = match sample.density {
                    _ if is_interpolated => 0.0,
                    None => punctual_weight,
                    Some(density) if sample.is_near => {
                        power_heuristic(density * lights_per_path, lobes.spread_density(sample.direction))
                    }
                    Some(_) => 1.0,
                };
                Split { own: spread * spread_share + sharp.own * share, carried: sharp.carried * share }
            });
        }
        let mut sum = ScatteredLight::default();
        if let Some(unshaded) = unshaded {
            let missing = sampled_unshaded.get() / (PI * f64::from(draws.total));
            let unshaded_light = spread_albedo * (unshaded - missing) * f64::from(paths);
            sum.light += Split { own: unshaded_light, carried: DVec3::ZERO };
        }
        for index in 0..paths {
            let random = PathRandom::new(direction_seed, slot.index * paths + index);
            let mut path = Path { random, inside, lights: LightsPerDirection::uniform(lights_per_path) };
            if !is_interpolated {
                let sent = self.trace_emitter(point, at.position, lobes, &mut path).map(|(_, sent)| sent);
                sum.light += Split { own: sent.unwrap_or_default(), carried: DVec3::ZERO };
            }
            let dispersed = self.disperse(at, &mut path);
            sum += match path.inside.channel {
                None => self.trace_sharp(point, at, lobes, &mut path, irradiance),
                Some(_) => {
                    let is_front = at.frame.geometric.dot(outgoing) >= 0.0;
                    let interface = self.media.interface(at.material, &path.inside, is_front);
                    let bsdf = Bsdf::new(&at.surface, at.frame, interface);
                    self.trace_sharp(point, at, &bsdf.toward(outgoing), &mut path, irradiance)
                        .scaled(dispersed)
                }
            };
        }
        let ScatteredLight { light, noisy } = sum * (1.0 / f64::from(paths));
        let sum = ScatteredLight { light: light + direct * (1.0 / f64::from(draws.total)), noisy };
        if is_gloss_interpolated { sum.carried() } else { sum }
    }

    /// Samples a direction of the spread lobes and returns it with the radiance scattered from an emitter there, if it
    /// hits one.
    pub(super) fn trace_emitter(
        &self,
        point: SurfacePoint,
        position: DVec3,
        lobes: &OutgoingBsdf<'_, '_>,
        path: &mut Path,
    ) -> Option<(DVec3, DVec3)> {
        if !self.lights.has_emitters() {
            return None;
        }
        let (direction, density) = lobes.sample_spread(path.random.next2())?;
        let light = self.emitter_light_along(point, position, direction, density, path);
        let sent = || lobes.scatter_parts(direction).0.spread * light / density;
        (light != DVec3::ZERO).then(|| (direction, sent()))
    }

    /// Light scattered by sharp lobes, found by one path that uses the cached irradiance.
    pub(super) fn trace_sharp(
        &self,
        point: SurfacePoint,
        at: &MaterialPoint,
        lobes: &OutgoingBsdf<'_, '_>,
        path: &mut Path,
        irradiance: &Irradiance,
    ) -> ScatteredLight {
        let Some(scattered) = lobes.sample_sharp(path.random.next3()) else {
            return ScatteredLight::default();
        };
        let step = self.step(point, at, &scattered, path);
        let path_light = self.trace_path(step, path, IrradianceLookup::Trusted(irradiance));
        ScatteredLight::from_direction(
            &scattered,
            path_light.direct + path_light.cached_light(),
            path_light.indirect,
        )
    }
}
