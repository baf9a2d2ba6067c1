//! What spots of a picture receive.

mod asked;
pub(super) mod drawn;

use super::{LightsAPath, Path, Transport, heuristic};
use crate::irradiance::patches::facing;
use crate::irradiance::place::Place;
use crate::lights::LightSample;
use crate::material_point::MaterialPoint;
use crate::path_random::PathRandom;
use crate::spots::{self, Measure, Measured, Seen};
use asked::Asked;
use drawn::{Drawing, Drawn};
use glam::{DVec3, Vec3};
use material::{Bsdf, Frame, Parts, Toward};
use scene::SurfacePoint;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_1_PI;
use trace::{Received, Spot};

/// Paths by which rough gloss is told that sends little of the light that comes, as varnish does, over how many lights are drawn for
/// a point asked alone.
const PATHS: u32 = 2;

/// The same of gloss that sends so large a share of it as metals do.
const PATHS_OF_METAL: u32 = 8;
const AS_METAL: f64 = 0.25;

/// From nearer to the horizon than this, sine, light is told as even: a normal that is turned a little would find it elsewhere.
const GRAZING: f64 = 0.1;

impl Transport {
    /// What spots receive that are of one surface with others.
    pub(super) fn receive(&self, spots: &[Spot], eye: DVec3) -> Vec<Option<Received>> {
        let mut received = vec![None; spots.len()];
        let Some(irradiance) = self.kept.trusted() else { return received };
        let scene = self.scene();
        let mut surfaces: BTreeMap<(u32, bool, u8), Vec<usize>> = BTreeMap::new();
        let mut asked = Asked {
            transport: self,
            irradiance,
            spots,
            eye,
            sky: self.sky(),
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

impl Measure for Asked<'_> {
    fn measure(&self, spot: usize) -> Option<Measured> {
        let Self { transport, irradiance, .. } = self;
        let (point, place, inside) = (self.spots[spot].point, &self.places[spot], self.inside[spot]);
        let indirect = irradiance.indirect(place)?;
        // Spread lobes do not send on light from everywhere alike: what they send is told as the irradiance that would do.
        let at = MaterialPoint {
            frame: Frame::new(self.geometric(spot), transport.scene().shading_normal(point), DVec3::ZERO),
            ..MaterialPoint::of(transport.scene(), point, transport.options.scattering)
        };
        let interface = transport.media.interface(at.material, &inside, self.is_front[spot]);
        let bsdf = Bsdf::new(&at.surface, at.frame, interface);
        let lobes = bsdf.toward((self.eye - place.position).normalize_or_zero());
        let spread = lobes.spread_albedo();
        let albedo = [spread, lobes.albedo().own - spread];
        // What comes through is found on the other side, where lights are not drawn here.
        let lets_through = at.surface.transmission > 0.0 || at.surface.diffuse_transmission > 0.0;
        let has_gloss = transport.scene().material_of(point.triangle).has_even_gloss() && !lets_through;
        let mut measured = Measured {
            received: Received {
                even: indirect,
                gloss: has_gloss.then_some(Vec3::ZERO),
                ..Received::default()
            },
            normal: place.normal,
            albedo: albedo.map(DVec3::as_vec3),
            sent: Vec3::ZERO,
            lights: Seen::default(),
        };
        if albedo == [DVec3::ZERO; 2] {
            return Some(measured);
        }
        let drawing = self.draw(spot);
        measured.lights = drawing.seen;
        let facing = Facing { spot, point, at: &at, lobes: &lobes };
        let [by_spread, by_gloss] = albedo.map(inverse);
        self.add_drawn(&mut measured.received, &facing, by_spread, &drawing);
        self.add_looked_for(&mut measured.received, &facing, by_spread, &drawing);
        if has_gloss && albedo[1].max_element() > 0.0 {
            measured.received.gloss = Some((self.gloss(&facing, &drawing) * by_gloss).as_vec3());
        }
        measured.sent = self.sent(&measured, &measured.received);
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
        self.sees_otherwise(spot, turn, agreed)
    }
}

/// A spot's surface, as it sends light toward the eye.
struct Facing<'a, 'b> {
    spot: usize,
    point: SurfacePoint,
    at: &'a MaterialPoint,
    lobes: &'a Toward<'b, 'b>,
}

impl Asked<'_> {
    /// Adds what spread lobes receive of lights that were drawn: of the sky, that nothing shades which is known, what is missing.
    fn add_drawn(&self, received: &mut Received, facing: &Facing, by_spread: DVec3, drawing: &Drawing) {
        let Self { transport, irradiance, .. } = self;
        let (place, inside) = (&self.places[facing.spot], &self.inside[facing.spot]);
        let unshaded = irradiance.unshaded(&transport.world, place.normal);
        let lights_a_look = f64::from(drawing.of_areas) / f64::from(self.light_samples());
        let cosine = |from: DVec3| place.normal.dot(from);
        // The sky's samples tell what share of it is missing: none is, or all, where none is seen, or all, to the last bit.
        let of_sky = |drawn: &&Drawn| drawn.sample.is_of_sky();
        let drawn_of_sky = drawing.lights.iter().filter(of_sky).map(|drawn| {
            drawn.sample.light.as_dvec3()
                * cosine(drawn.sample.from)
                * FRAC_1_PI
                * drawing.share(&drawn.sample)
        });
        let as_unshaded = unshaded.map_or(DVec3::ONE, |unshaded| unshaded * inverse(drawn_of_sky.sum()));
        for drawn in &drawing.lights {
            let Drawn { sample, is_seen } = drawn;
            let cosine = cosine(sample.from);
            let is_known = of_sky(&drawn) && unshaded.is_some();
            if !is_seen && !is_known {
                continue;
            }
            let (Parts { spread, .. }, _) = facing.lobes.scatter_parts(sample.from);
            let sent = if *is_seen { spread * by_spread } else { DVec3::ZERO };
            let known = if is_known { cosine * FRAC_1_PI } else { 0.0 };
            let scale = if is_known { as_unshaded } else { DVec3::ONE };
            let share = match sample.density {
                Some(density) if sample.is_near => {
                    let own = facing.lobes.spread_density(sample.from);
                    heuristic(density * lights_a_look, own)
                }
                _ => 1.0,
            } * drawing.share(sample);
            let light = transport.light_of(sample, place.position, inside);
            received.add(light * scale * (sent - known) * share, sample.from, cosine);
        }
    }

    /// Adds what spread lobes receive of lamps that are found by directions they are looked for in.
    fn add_looked_for(&self, received: &mut Received, facing: &Facing, by_spread: DVec3, drawing: &Drawing) {
        let place = &self.places[facing.spot];
        let looks = self.light_samples();
        let lights_a_path = f64::from(drawing.of_areas) / f64::from(looks);
        for index in 0..looks {
            let random = PathRandom::new(drawn::LOOKING, index);
            let inside = self.inside[facing.spot];
            let mut path = Path { random, inside, lights: LightsAPath::each(lights_a_path) };
            let found = self.transport.looked_for(facing.point, place.position, facing.lobes, &mut path);
            if let Some((direction, sent)) = found {
                let cosine = place.normal.dot(direction);
                received.add(sent * by_spread / f64::from(looks), direction, cosine);
            }
        }
    }

    /// What own gloss sends toward the eye.
    fn gloss(&self, facing: &Facing, drawing: &Drawing) -> DVec3 {
        let (place, inside) = (&self.places[facing.spot], self.inside[facing.spot]);
        let sent_of_all = (facing.lobes.albedo().own - facing.lobes.spread_albedo()).max_element();
        let paths = if sent_of_all < AS_METAL { PATHS } else { PATHS_OF_METAL } * self.light_samples();
        // All spots draw the same few directions of the sky, which tell what share of it is seen; many more tell what all of it sends.
        let [sky, lamps] =
            [self.sky.len() as f64, drawing.of_areas.into()].map(|draws| draws / f64::from(paths));
        let lights = LightsAPath { sky, lamps };
        let sent_of = |sample: &LightSample, light: DVec3| {
            let (Parts { sharp, .. }, own) = facing.lobes.scatter_parts(sample.from);
            light
                * sharp.own
                * sample.density.map_or(1.0, |density| heuristic(density * lights.of(sample), own))
        };
        let mut sent = DVec3::ZERO;
        let [mut sky, mut seen_sky] = [DVec3::ZERO; 2];
        for Drawn { sample, is_seen } in &drawing.lights {
            let is_sky = sample.is_of_sky();
            if !is_sky && !is_seen {
                continue;
            }
            let light = self.transport.light_of(sample, place.position, &inside);
            let sent_of = sent_of(sample, light) * drawing.share(sample);
            match (is_sky, is_seen) {
                (true, true) => (sky, seen_sky) = (sky + sent_of, seen_sky + sent_of),
                (true, false) => sky += sent_of,
                (false, _) => sent += sent_of,
            }
        }
        if seen_sky != DVec3::ZERO {
            let above = self.sky.iter().filter(|sample| place.normal.dot(sample.from) > 0.0);
            let open: DVec3 = above.map(|sample| sent_of(sample, sample.light.as_dvec3())).sum();
            sent += seen_sky * inverse(sky) * open / self.sky.len() as f64;
        }
        for index in 0..paths {
            let random = PathRandom::new(drawn::LOOKING, index);
            let mut path = Path { random, inside, lights };
            let found =
                self.transport.sharp(facing.point, facing.at, facing.lobes, &mut path, self.irradiance);
            sent += found.light.own / f64::from(paths);
        }
        sent
    }
}

/// One over each channel; of nothing nothing.
fn inverse(of: DVec3) -> DVec3 {
    of.map(|of_channel| if of_channel > 0.0 { of_channel.recip() } else { 0.0 })
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
