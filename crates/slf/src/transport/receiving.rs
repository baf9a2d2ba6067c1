//! What spots of a picture receive.

use super::{Path, Transport, heuristic};
use crate::irradiance::Irradiance;
use crate::irradiance::patches::facing;
use crate::irradiance::place::Place;
use crate::lights::{LightSample, Lights};
use crate::material_point::MaterialPoint;
use crate::media::Inside;
use crate::path_random::PathRandom;
use crate::spots::{self, Measure, Measured, Seen};
use glam::{DVec3, Vec3};
use material::{Bsdf, Frame, Parts};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_1_PI;
use trace::{Received, Spot};

/// Lights that are drawn for every spot, the same ones.
const LIGHTS: u32 = 64;

/// Directions that lamps are looked for in.
const LOOKS: u32 = 16;

/// Paths by which rough gloss is told.
const PATHS: u32 = 32;

/// From nearer to the horizon than this, sine, light is told as even: a normal that is turned a little would find it elsewhere.
const GRAZING: f64 = 0.1;

/// Some spots of a picture, as rays ask about them.
struct Asked<'a> {
    transport: &'a Transport,
    irradiance: &'a Irradiance,
    spots: &'a [Spot],
    eye: DVec3,
    places: Vec<Place>,
    is_front: Vec<bool>,
    inside: Vec<Inside>,
}

impl Transport {
    /// What spots receive that are of one surface with others.
    pub(super) fn receive(&self, spots: &[Spot], eye: DVec3) -> Vec<Option<Received>> {
        let mut received = vec![None; spots.len()];
        let Some(irradiance) = self.irradiance.as_deref() else { return received };
        let scene = self.scene();
        let mut surfaces: BTreeMap<(u32, bool, u8), Vec<usize>> = BTreeMap::new();
        let mut asked = Asked {
            transport: self,
            irradiance,
            spots,
            eye,
            places: Vec::new(),
            is_front: Vec::new(),
            inside: Vec::new(),
        };
        for (number, spot) in spots.iter().enumerate() {
            let triangle = spot.point.triangle;
            let toward = eye - spot.point.position(scene);
            let is_front = scene.area_normal(triangle).dot(toward) >= 0.0;
            let material = scene.material_of(triangle);
            asked.is_front.push(is_front);
            let place = Place::of(scene, spot.point, is_front);
            asked.places.push(place);
            asked.inside.push(self.media.beside(scene.part_of(triangle).material, is_front));
            if !material.unlit {
                let key = (place.part, is_front, facing(place.normal));
                surfaces.entry(key).or_default().push(number);
            }
        }
        for surface in surfaces.values() {
            spots::tell(spots, surface, &asked, |spot, told| received[spot] = Some(told));
        }
        received
    }
}

impl Asked<'_> {
    /// Visits the lights of draw `index`, each with its bit: which kind it is, and which of that kind.
    fn visit_lights(&self, spot: usize, index: u32, mut visit: impl FnMut(LightSample, (usize, u64))) {
        let transport = self.transport;
        let position = self.places[spot].position;
        let draws = transport.lights.draws(LIGHTS);
        let mut random = self.random(false, index);
        let mut punctual = index * Lights::MOST_A_DRAW;
        transport.lights.sample(
            transport.scene(),
            &transport.world,
            position,
            index < draws.punctual,
            || random.next(),
            |sample| {
                let bit = match (sample.density, sample.is_near) {
                    (Some(_), false) => (0, 1 << index),
                    (Some(_), true) => (1, 1 << index),
                    (None, _) => {
                        punctual += 1;
                        (2, 1 << ((punctual - 1) % u64::BITS))
                    }
                };
                visit(sample, bit);
            },
        );
    }

    /// The numbers of a draw, the same for all spots.
    fn random(&self, looks: bool, index: u32) -> PathRandom {
        const SEED: u64 = 0x5eed_0f5b_0751_1157;
        PathRandom::new(if looks { !SEED } else { SEED }, index)
    }

    /// The normal of a spot's triangle, on the front.
    fn geometric(&self, spot: usize) -> DVec3 {
        self.transport.scene().area_normal(self.spots[spot].point.triangle).normalize_or_zero()
    }

    /// Whether nothing stands between a spot and a light.
    fn sees(&self, spot: usize, light: &LightSample) -> bool {
        !self.transport.tracer.occluded(self.spots[spot].point, light.source)
    }
}

impl Measure for Asked<'_> {
    fn measure(&self, spot: usize) -> Option<Measured> {
        let Self { transport, irradiance, .. } = self;
        let (point, place, inside) = (self.spots[spot].point, &self.places[spot], self.inside[spot]);
        let mut received = Received { even: irradiance.indirect(place)?, ..Received::default() };
        // Spread lobes do not send on light from everywhere alike: what they send is told as the irradiance that would do.
        let at = MaterialPoint {
            frame: Frame::new(self.geometric(spot), transport.scene().shading_normal(point), DVec3::ZERO),
            ..MaterialPoint::of(transport.scene(), point, transport.options.scattering)
        };
        let interface = transport.media.interface(at.material, &inside, self.is_front[spot]);
        let bsdf = Bsdf::new(&at.surface, at.frame, interface);
        let lobes = bsdf.toward((self.eye - place.position).normalize_or_zero());
        let spread = lobes.spread_albedo();
        let gloss = lobes.albedo().own - spread;
        let albedo = [spread, gloss].map(DVec3::as_vec3);
        // What comes through is found on the other side, where lights are not drawn here.
        let lets_through = at.surface.transmission > 0.0 || at.surface.diffuse_transmission > 0.0;
        let has_gloss = transport.scene().material_of(point.triangle).has_even_gloss() && !lets_through;
        let looks = if has_gloss && gloss.max_element() > 0.0 { PATHS } else { 0 };
        received.gloss = has_gloss.then_some(Vec3::ZERO);
        let normal = place.normal;
        if albedo == [Vec3::ZERO; 2] {
            return Some(Measured { received, normal, albedo, sent: Vec3::ZERO, lights: Seen::default() });
        }
        let [by_spread, by_gloss] = [spread, gloss]
            .map(|albedo| albedo.map(|of_channel| if of_channel > 0.0 { of_channel.recip() } else { 0.0 }));
        let mut lights = Seen::default();
        let draws = transport.lights.draws(LIGHTS);
        let [lights_a_look, lights_a_path] =
            [LOOKS, PATHS].map(|ways| f64::from(draws.all) / f64::from(ways));
        let mut glossy = DVec3::ZERO;
        let has_unshaded = irradiance.unshaded(&transport.world, place.normal).is_some();
        for index in 0..draws.all {
            self.visit_lights(spot, index, |sample, (kind, bit)| {
                let cosine = place.normal.dot(sample.from);
                if cosine <= 0.0 || sample.light == Vec3::ZERO {
                    return;
                }
                lights.above[kind] |= bit;
                let sees = self.sees(spot, &sample);
                if sees {
                    lights.seen[kind] |= bit;
                }
                let (Parts { spread, sharp }, of_sharp) = lobes.scatter_parts(sample.from);
                let sent = spread * by_spread;
                // Of what the sky sends unshaded, which is known, what is missing is told.
                let is_of_sky = sample.density.is_some() && !sample.is_near;
                let known = if has_unshaded && is_of_sky { cosine * FRAC_1_PI } else { 0.0 };
                let sent = if sees { sent - known } else { DVec3::splat(-known) };
                let way = if sample.is_near { place.position.distance(sample.source) } else { f64::INFINITY };
                let light = sample.light.as_dvec3() * transport.media.attenuation(&inside, way);
                let share = match sample.density {
                    None => 1.0 / f64::from(draws.punctual),
                    Some(density) if sample.is_near => {
                        let own = lobes.spread_density(sample.from);
                        heuristic(density * lights_a_look, own) / f64::from(draws.all)
                    }
                    Some(_) => 1.0 / f64::from(draws.all),
                };
                received.add(light * sent * share, sample.from, cosine);
                if sees && looks > 0 {
                    let share = sample.density.map_or(1.0 / f64::from(draws.punctual), |density| {
                        heuristic(density * lights_a_path, of_sharp) / f64::from(draws.all)
                    });
                    glossy += light * sharp.own * share;
                }
            });
        }
        for index in 0..looks {
            let random = self.random(true, LOOKS + index);
            let mut path = Path { random, inside, lights_a_path };
            let found = transport.sharp(point, &at, &lobes, &mut path, irradiance);
            glossy += found.light.own / f64::from(looks);
        }
        received.gloss = has_gloss.then(|| (glossy * by_gloss).as_vec3());
        if transport.lights.has_emitters() {
            for index in 0..LOOKS {
                let mut random = self.random(true, index);
                let Some((direction, density)) = lobes.sample_spread(random.next2()) else { continue };
                let path = Path { random, inside, lights_a_path: lights_a_look };
                let light = transport.lamp_along(point, place.position, direction, density, &path);
                if light != DVec3::ZERO {
                    let sent = lobes.scatter_parts(direction).0.spread * by_spread;
                    let cosine = place.normal.dot(direction);
                    received.add(light * sent / (density * f64::from(LOOKS)), direction, cosine);
                }
            }
        }
        let mut measured = Measured { received, normal, albedo, sent: Vec3::ZERO, lights };
        measured.sent = self.sent(&measured, &received);
        Some(measured)
    }

    fn normal(&self, spot: usize) -> DVec3 {
        self.places[spot].normal
    }

    fn sent(&self, measured: &Measured, received: &Received) -> Vec3 {
        let irradiance = self.irradiance.received(&self.transport.world, received, measured.normal).as_vec3();
        let [spread, gloss] = measured.albedo;
        irradiance * spread + received.gloss.unwrap_or_default() * gloss
    }

    fn differs(&self, spot: usize, turn: usize, agreed: &Seen) -> Option<bool> {
        let draws = self.transport.lights.draws(LIGHTS);
        // An odd step takes turns with all of a power of two.
        const STEP: usize = 37;
        let index = (turn * STEP % draws.all as usize) as u32;
        let mut differs = None;
        self.visit_lights(spot, index, |sample, (kind, bit)| {
            if agreed.above[kind] & bit != 0 && self.places[spot].normal.dot(sample.from) > 0.0 {
                let sees = self.sees(spot, &sample);
                *differs.get_or_insert(false) |= sees != (agreed.seen[kind] & bit != 0);
            }
        });
        differs
    }
}

trait Adds {
    fn add(&mut self, irradiance: DVec3, from: DVec3, cosine: f64);
}

impl Adds for Received {
    /// Adds irradiance/π that arrives from a direction, at so much of an angle to the normal.
    fn add(&mut self, irradiance: DVec3, from: DVec3, cosine: f64) {
        if cosine < GRAZING {
            self.even += irradiance.as_vec3();
            return;
        }
        let flow = irradiance / cosine;
        for (axis, by) in self.flow.iter_mut().zip(from.to_array()) {
            *axis += (flow * by).as_vec3();
        }
    }
}
