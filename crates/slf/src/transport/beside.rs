//! What rays find beside what is known.

use super::gathered::Gathered;
use super::receiving::drawn;
use super::{Known, LightsAPath, Path, Transport, each_of, heuristic};
use crate::irradiance::Irradiance;
use crate::material_point::MaterialPoint;
use crate::media::Inside;
use crate::path_random::PathRandom;
use glam::DVec3;
use material::{Bsdf, Parts, Split, Toward};
use scene::SurfacePoint;
use std::cell::Cell;
use std::f64::consts::PI;
use trace::Among;

/// What lobes send of all light that comes, from which on as many paths look for it as may.
const MATTERS: f64 = 0.5;

/// How many times as many lights are drawn where spread light is not told.
const SPREAD_LIGHTS: u32 = 2;

impl Transport {
    /// What a surface scatters toward the eye where irradiance is known, but for what that tells: of drawn lights all, of other
    /// light what sharp lobes send.
    pub(super) fn scattered_beside(
        &self,
        point: SurfacePoint,
        at: &MaterialPoint,
        (lobes, outgoing): (&Toward<'_, '_>, DVec3),
        inside: Inside,
        (irradiance, among): (&Irradiance, Among),
    ) -> Gathered {
        let (Split { own, carried }, spread_albedo) = (lobes.albedo(), lobes.spread_albedo());
        let is_told = among.received.is_some();
        let own_is_told = among.received.is_some_and(|received| received.gloss.is_some());
        // Where nothing is sharp, paths only look for lamps that are large; where all else is told, there are as many as what they
        // may find matters.
        let share = match is_told {
            true => {
                let asked = if own_is_told { DVec3::ZERO } else { own - spread_albedo };
                ((asked + carried).max_element() / MATTERS).min(1.0).powi(2)
            }
            false if lobes.is_spread() => 0.25,
            false => 1.0,
        };
        let of = |wanted: u32| (f64::from(wanted) * share).ceil() as u32;
        let paths = each_of(among, of(self.options.paths));
        let of_lights = match is_told {
            true => of(self.options.light_samples),
            false => SPREAD_LIGHTS * self.options.light_samples,
        };
        let draws = self.lights.draws(each_of(among, of_lights));
        let lights_a_path = f64::from(draws.all) / f64::from(paths);
        let of_punctual = f64::from(draws.all) / f64::from(draws.punctual);
        // Of a part of a picture what is spread widely draws and looks as its neighbours do: what is off is off for all of them
        // alike.
        let is_part = among.count > 1 && !own_is_told;
        let light_seed = if is_part && !is_told { drawn::SEED } else { among.seed };
        let look_seed = if is_part && carried == DVec3::ZERO { drawn::LOOKING } else { !among.seed };
        // What the sky would send, did nothing shade it, is known: it is put in for what its samples would find of it, so that they
        // only tell what is missing (a control variate: the mean stays).
        let normal = lobes.normal();
        let unshaded = if is_told { None } else { irradiance.unshaded(&self.world, normal) };
        let drawn_unshaded = Cell::new(DVec3::ZERO);
        let mut drawn = Split::default();
        for index in 0..draws.all {
            let random = PathRandom::new(light_seed, among.index * draws.all + index);
            let mut path = Path { random, inside, lights: LightsAPath::each(lights_a_path) };
            drawn += self.direct_by(point, at, &mut path, index < draws.punctual, |sample| {
                let (Parts { spread, sharp }, own) = lobes.scatter_parts(sample.from);
                if sample.density.is_some() && !sample.is_near {
                    let light = sample.light.as_dvec3() * normal.dot(sample.from).max(0.0);
                    drawn_unshaded.set(drawn_unshaded.get() + light);
                }
                let share =
                    sample.density.map_or(of_punctual, |density| heuristic(density * lights_a_path, own));
                // Of spread light only lamps are looked for in two ways.
                let of_spread = match sample.density {
                    _ if is_told => 0.0,
                    None => of_punctual,
                    Some(density) if sample.is_near => {
                        heuristic(density * lights_a_path, lobes.spread_density(sample.from))
                    }
                    Some(_) => 1.0,
                };
                Split { own: spread * of_spread + sharp.own * share, carried: sharp.carried * share }
            });
        }
        let mut found = Gathered::default();
        if let Some(unshaded) = unshaded {
            let missing = drawn_unshaded.get() / (PI * f64::from(draws.all));
            let known = spread_albedo * (unshaded - missing) * f64::from(paths);
            found.light += Split { own: known, carried: DVec3::ZERO };
        }
        for index in 0..paths {
            let random = PathRandom::new(look_seed, among.index * paths + index);
            let mut path = Path { random, inside, lights: LightsAPath::each(lights_a_path) };
            if !is_told {
                let sent = self.looked_for(point, at.position, lobes, &mut path).map(|(_, sent)| sent);
                found.light += Split { own: sent.unwrap_or_default(), carried: DVec3::ZERO };
            }
            let dispersed = self.disperse(at, &mut path);
            found += match path.inside.channel {
                None => self.sharp(point, at, lobes, &mut path, irradiance),
                Some(_) => {
                    let is_front = at.frame.geometric.dot(outgoing) >= 0.0;
                    let interface = self.media.interface(at.material, &path.inside, is_front);
                    let bsdf = Bsdf::new(&at.surface, at.frame, interface);
                    self.sharp(point, at, &bsdf.toward(outgoing), &mut path, irradiance).split(dispersed)
                }
            };
        }
        let Gathered { light, by_chance } = found * (1.0 / f64::from(paths));
        let found = Gathered { light: light + drawn * (1.0 / f64::from(draws.all)), by_chance };
        if own_is_told { found.carried() } else { found }
    }

    /// What spread lobes send of a lamp that one direction finds, drawn by how the surface scatters: that direction, and the radiance.
    pub(super) fn looked_for(
        &self,
        point: SurfacePoint,
        position: DVec3,
        lobes: &Toward<'_, '_>,
        path: &mut Path,
    ) -> Option<(DVec3, DVec3)> {
        if !self.lights.has_emitters() {
            return None;
        }
        let (direction, density) = lobes.sample_spread(path.random.next2())?;
        let light = self.lamp_along(point, position, direction, density, path);
        let sent = || lobes.scatter_parts(direction).0.spread * light / density;
        (light != DVec3::ZERO).then(|| (direction, sent()))
    }

    /// What sharp lobes send of all light that one path finds, where irradiance is known.
    pub(super) fn sharp(
        &self,
        point: SurfacePoint,
        at: &MaterialPoint,
        lobes: &Toward<'_, '_>,
        path: &mut Path,
        irradiance: &Irradiance,
    ) -> Gathered {
        let Some(scattered) = lobes.sample_sharp(path.random.next3()) else { return Gathered::default() };
        let step = self.step(point, at, &scattered, path);
        let arriving = self.arriving(step, path, Known::All(irradiance));
        Gathered::by(&scattered, arriving.drawn + arriving.sent_on(), arriving.other)
    }
}
