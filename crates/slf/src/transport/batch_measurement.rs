//! Measurement of incident light at the points of a picture.

mod point_batch;
pub(super) mod shared_lights;

use super::{LightsPerDirection, Path, Transport, power_heuristic};
use crate::irradiance::patches::facing;
use crate::irradiance::place::Place;
use crate::light_interpolation::{self, IncidentSampler, LightVisibility, Measurement};
use crate::lights::LightSample;
use crate::material_point::MaterialPoint;
use crate::path_random::PathRandom;
use glam::{DVec3, Vec3};
use material::{Bsdf, Frame, OutgoingBsdf, Parts};
use point_batch::PointBatch;
use scene::SurfacePoint;
use shared_lights::{LightDraws, SampledLight};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_1_PI;
use trace::{IncidentLight, ShadingPoint};

/// Paths per light sample for rough gloss with a small albedo, such as varnish.
const GLOSS_PATHS_FACTOR: u32 = 2;

/// The same for gloss with a large albedo, such as metal, from this albedo on.
const METAL_PATHS_FACTOR: u32 = 8;
const METAL_ALBEDO: f64 = 0.25;

/// How many times fewer of the sky's directions gloss with a small albedo takes.
const FEWER_SKY_DIRECTIONS: usize = 4;

/// Light with a smaller cosine to the normal counts as isotropic: a slightly rotated normal would receive it
/// differently.
const MIN_COSINE: f64 = 0.1;

impl Transport {
    /// Measures or interpolates the incident light of all points that share a surface with others.
    pub(super) fn measure_batch(&self, points: &[ShadingPoint], eye: DVec3) -> Vec<Option<IncidentLight>> {
        let mut results = vec![None; points.len()];
        let Some(irradiance) = self.cache_mode.trusted() else { return results };
        let scene = self.scene();
        let mut surfaces: BTreeMap<(u32, bool, u8), Vec<usize>> = BTreeMap::new();
        let mut batch = PointBatch {
            transport: self,
            irradiance,
            points,
            eye,
            sky_samples: self.sky_samples(),
            places: Vec::new(),
            is_front: Vec::new(),
            inside: Vec::new(),
        };
        for (index, shading_point) in points.iter().enumerate() {
            let triangle = shading_point.point.triangle;
            let toward = eye - shading_point.point.position(scene);
            let is_front = scene.area_normal(triangle).dot(toward) >= 0.0;
            let material = scene.material_of(triangle);
            batch.is_front.push(is_front);
            let place = Place::new(scene, shading_point.point, is_front);
            batch.places.push(place);
            batch.inside.push(self.media.outgoing_medium(scene.part_of(triangle).material, is_front));
            if !material.unlit {
                let key = (place.part, is_front, facing(place.normal));
                surfaces.entry(key).or_default().push(index);
            }
        }
        for surface in surfaces.values() {
            light_interpolation::interpolate_incident(points, surface, &batch, |index, incident| {
                results[index] = Some(incident)
            });
        }
        results
    }
}

impl IncidentSampler for PointBatch<'_> {
    fn measure(&self, index: usize) -> Option<Measurement> {
        let Self { transport, irradiance, .. } = self;
        let (point, place, inside) = (self.points[index].point, &self.places[index], self.inside[index]);
        let indirect = irradiance.indirect(*transport, place)?;
        // Spread lobes are not perfectly diffuse: what they scatter is stored as the irradiance that would have the
        // same effect.
        let at = MaterialPoint {
            frame: Frame::new(
                self.geometric_normal(index),
                transport.scene().shading_normal(point),
                DVec3::ZERO,
            ),
            ..MaterialPoint::new(transport.scene(), point, transport.options.scattering)
        };
        let interface = transport.media.interface(at.material, &inside, self.is_front[index]);
        let bsdf = Bsdf::new(&at.surface, at.frame, interface);
        let lobes = bsdf.toward((self.eye - place.position).normalize_or_zero());
        let spread = lobes.spread_albedo();
        let albedo = [spread, lobes.albedo().own - spread];
        // Transmitted light comes from the other side, where lights are not sampled here.
        let lets_through = at.surface.transmission > 0.0 || at.surface.diffuse_transmission > 0.0;
        let has_gloss = transport.scene().material_of(point.triangle).has_uniform_gloss() && !lets_through;
        let mut measured = Measurement {
            incident: IncidentLight {
                isotropic: indirect,
                gloss: has_gloss.then_some(Vec3::ZERO),
                ..IncidentLight::default()
            },
            normal: place.normal,
            albedo: albedo.map(DVec3::as_vec3),
            outgoing: Vec3::ZERO,
            visibility: LightVisibility::default(),
        };
        if albedo == [DVec3::ZERO; 2] {
            return Some(measured);
        }
        let draws = self.sample_lights(index);
        measured.visibility = draws.visibility;
        let facing = FacingPoint { index, point, at: &at, lobes: &lobes };
        let [per_spread, per_gloss] = albedo.map(reciprocal);
        self.add_sampled_lights(&mut measured.incident, &facing, per_spread, &draws);
        self.add_traced_emitters(&mut measured.incident, &facing, per_spread, &draws);
        if has_gloss && albedo[1].max_element() > 0.0 {
            measured.incident.gloss = Some((self.gloss(&facing, &draws) * per_gloss).as_vec3());
        }
        measured.outgoing = self.outgoing(&measured, &measured.incident);
        Some(measured)
    }

    fn normal(&self, index: usize) -> DVec3 {
        self.places[index].normal
    }

    fn outgoing(&self, measured: &Measurement, incident: &IncidentLight) -> Vec3 {
        let irradiance = self.irradiance.shaded(&self.transport.world, incident, measured.normal).as_vec3();
        let [spread, gloss] = measured.albedo;
        irradiance * spread + incident.gloss.unwrap_or_default() * gloss
    }

    fn visibility_differs(&self, index: usize, turn: usize, agreed: &LightVisibility) -> Option<bool> {
        self.compare_visibility(index, turn, agreed)
    }
}

/// A point prepared for shading toward the eye.
struct FacingPoint<'a, 'b> {
    index: usize,
    point: SurfacePoint,
    at: &'a MaterialPoint,
    lobes: &'a OutgoingBsdf<'b, 'b>,
}

impl PointBatch<'_> {
    /// Adds incident light of the spread lobes from sampled lights; of the sky, whose unoccluded light is known, the
    /// missing part.
    fn add_sampled_lights(
        &self,
        incident: &mut IncidentLight,
        facing: &FacingPoint,
        per_spread: DVec3,
        draws: &LightDraws,
    ) {
        let Self { transport, irradiance, .. } = self;
        let (place, inside) = (&self.places[facing.index], &self.inside[facing.index]);
        let unshaded = irradiance.unshaded(&transport.world, place.normal);
        let lights_per_path = f64::from(draws.area_draws) / f64::from(self.lights_per_point());
        let cosine = |direction: DVec3| place.normal.dot(direction);
        // The sky's samples give the occluded share: exactly none or all of it where all or none are visible.
        let is_sky = |sampled: &&SampledLight| sampled.sample.is_sky();
        let sampled_sky = draws.lights.iter().filter(is_sky).map(|sampled| {
            sampled.sample.light.as_dvec3()
                * cosine(sampled.sample.direction)
                * FRAC_1_PI
                * draws.share(&sampled.sample)
        });
        let to_unshaded = unshaded.map_or(DVec3::ONE, |unshaded| unshaded * reciprocal(sampled_sky.sum()));
        for sampled in &draws.lights {
            let SampledLight { sample, is_visible } = sampled;
            let cosine = cosine(sample.direction);
            let is_unshaded_sky = is_sky(&sampled) && unshaded.is_some();
            if !is_visible && !is_unshaded_sky {
                continue;
            }
            let (Parts { spread, .. }, _) = facing.lobes.scatter_parts(sample.direction);
            let sent = if *is_visible { spread * per_spread } else { DVec3::ZERO };
            let unshaded_cosine = if is_unshaded_sky { cosine * FRAC_1_PI } else { 0.0 };
            let scale = if is_unshaded_sky { to_unshaded } else { DVec3::ONE };
            let share = match sample.density {
                Some(density) if sample.is_near => {
                    let own = facing.lobes.spread_density(sample.direction);
                    power_heuristic(density * lights_per_path, own)
                }
                _ => 1.0,
            } * draws.share(sample);
            let light = transport.attenuated_light(sample, place.position, inside);
            incident.add_from(light * scale * (sent - unshaded_cosine) * share, sample.direction, cosine);
        }
    }

    /// Adds incident light of the spread lobes from emitters hit by sampled directions.
    fn add_traced_emitters(
        &self,
        incident: &mut IncidentLight,
        facing: &FacingPoint,
        per_spread: DVec3,
        draws: &LightDraws,
    ) {
        let place = &self.places[facing.index];
        let paths = self.lights_per_point();
        let lights_per_path = f64::from(draws.area_draws) / f64::from(paths);
        for index in 0..paths {
            let random = PathRandom::new(shared_lights::DIRECTION_SEED, index);
            let inside = self.inside[facing.index];
            let mut path = Path { random, inside, lights: LightsPerDirection::uniform(lights_per_path) };
            let traced = self.transport.trace_emitter(facing.point, place.position, facing.lobes, &mut path);
            if let Some((direction, sent)) = traced {
                let cosine = place.normal.dot(direction);
                incident.add_from(sent * per_spread / f64::from(paths), direction, cosine);
            }
        }
    }

    /// Radiance of the own gloss toward the eye.
    fn gloss(&self, facing: &FacingPoint, draws: &LightDraws) -> DVec3 {
        let (place, inside) = (&self.places[facing.index], self.inside[facing.index]);
        let gloss_albedo = (facing.lobes.albedo().own - facing.lobes.spread_albedo()).max_element();
        let (paths_factor, directions) = if gloss_albedo < METAL_ALBEDO {
            (GLOSS_PATHS_FACTOR, self.sky_samples.len() / FEWER_SKY_DIRECTIONS)
        } else {
            (METAL_PATHS_FACTOR, self.sky_samples.len())
        };
        let paths = paths_factor * self.lights_per_point();
        let sky_samples = &self.sky_samples[..directions];
        // All points sample the same few directions of the sky, which give its visible share; many more give the light
        // of all of it.
        let [sky, emitters] =
            [sky_samples.len() as f64, draws.area_draws.into()].map(|count| count / f64::from(paths));
        let lights = LightsPerDirection { sky, emitters };
        let gloss_toward = |sample: &LightSample, light: DVec3| {
            let (Parts { sharp, .. }, lobe_density) = facing.lobes.scatter_parts(sample.direction);
            light
                * sharp.own
                * sample
                    .density
                    .map_or(1.0, |density| power_heuristic(density * lights.for_sample(sample), lobe_density))
        };
        let mut sent = DVec3::ZERO;
        let [mut sky, mut visible_sky] = [DVec3::ZERO; 2];
        for SampledLight { sample, is_visible } in &draws.lights {
            let is_sky = sample.is_sky();
            if !is_sky && !is_visible {
                continue;
            }
            let light = self.transport.attenuated_light(sample, place.position, &inside);
            let gloss_light = gloss_toward(sample, light) * draws.share(sample);
            match (is_sky, is_visible) {
                (true, true) => (sky, visible_sky) = (sky + gloss_light, visible_sky + gloss_light),
                (true, false) => sky += gloss_light,
                (false, _) => sent += gloss_light,
            }
        }
        if visible_sky != DVec3::ZERO {
            let above_horizon = sky_samples.iter().filter(|sample| place.normal.dot(sample.direction) > 0.0);
            let open: DVec3 = above_horizon.map(|sample| gloss_toward(sample, sample.light.as_dvec3())).sum();
            sent += visible_sky * reciprocal(sky) * open / sky_samples.len() as f64;
        }
        for index in 0..paths {
            let random = PathRandom::new(shared_lights::DIRECTION_SEED, index);
            let mut path = Path { random, inside, lights };
            let path_light =
                self.transport.trace_sharp(facing.point, facing.at, facing.lobes, &mut path, self.irradiance);
            sent += path_light.light.own / f64::from(paths);
        }
        sent
    }
}

/// Reciprocal by channel; 0 for 0.
fn reciprocal(color: DVec3) -> DVec3 {
    color.map(|channel| if channel > 0.0 { channel.recip() } else { 0.0 })
}

trait AddDirectional {
    fn add_from(&mut self, irradiance: DVec3, direction: DVec3, cosine: f64);
}

impl AddDirectional for IncidentLight {
    /// Adds irradiance/π that arrives from a direction with this cosine to the normal.
    fn add_from(&mut self, irradiance: DVec3, direction: DVec3, cosine: f64) {
        if cosine < MIN_COSINE {
            self.isotropic += irradiance.as_vec3();
            return;
        }
        let flow = irradiance / cosine;
        for (axis, component) in self.vector_irradiance.iter_mut().zip(direction.to_array()) {
            *axis += (flow * component).as_vec3();
        }
    }
}
