//! Light transport: what surfaces send by themselves and what they scatter of each other's light, by paths.

mod beside;
mod gathered;
mod receiving;

use crate::irradiance::Irradiance;
use crate::irradiance::patches::{PatchPoint, Patches};
use crate::irradiance::place::Place;
use crate::lights::{LightSample, Lights};
use crate::material_point::{MaterialPoint, emitted};
use crate::media::{Inside, Media};
use crate::path_random::PathRandom;
use gathered::{Gathered, split};
use glam::{DVec3, Vec3};
use material::{Bsdf, Frame, Scattered, Scattering, Split, Surface, Toward};
use scene::{Scene, SurfacePoint, World};
use std::sync::{Arc, OnceLock};
use trace::{Among, Hit, Leaving, Radiance, Received, Spot, Tracer};

/// How light is gathered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TransportOptions {
    /// Paths for each point and eye, fewer where the mean of many points is wanted ([`Radiance::leaving_among`]). Their noise is that
    /// of the picture where each surface point is asked once; where many points fall into a pixel, as in the ground truth, one will do.
    pub paths: u32,
    /// Lights that are drawn for each point and eye, where irradiance is known; elsewhere each path draws one.
    pub light_samples: u32,
    /// Whether light that meets microfacets more than once counts.
    pub scattering: Scattering,
}

impl Default for TransportOptions {
    fn default() -> Self {
        Self { paths: 32, light_samples: 16, scattering: Scattering::Multiple }
    }
}

/// Radiance of a lit scene, traced by paths (Kajiya 1986).
///
/// | surface | radiance |
/// | --- | --- |
/// | unlit | its base colour, on both sides |
/// | emissive | the emitted radiance, on the front; on both sides if double sided |
/// | any but unlit | + what its lobes scatter of light that arrives ([`Bsdf`]) |
///
/// At every surface a path meets, light is looked for in two ways: a light is drawn (an emissive triangle by what of its power
/// may arrive, a direction of the environment by its brightness, punctual lights all, or one by what it would send), and a direction is drawn by
/// how the surface scatters. What both may find is weighted by the power heuristic (Veach and Guibas 1995). Unlit surfaces send the
/// colour they show, and are found by the second way alone. Paths end by Russian roulette, or after the world's bounces: nothing
/// else is left out or cut off, so the mean over points and paths is exact, and depends on the point and the eye alone.
///
/// With [`Irradiance`] a path ends where it comes to what is known, that is, at the next diffuse surface; and what arrives at a
/// point's own diffuse lobes from other surfaces is known as well. That is faster by far, and off by what patches do not tell:
/// their mean stands for every point of them.
pub struct Transport {
    tracer: Arc<Tracer>,
    world: World,
    options: TransportOptions,
    lights: Lights,
    media: Media,
    irradiance: Option<Arc<Irradiance>>,
    /// Directions of the sky, once they are asked for.
    sky: OnceLock<Vec<LightSample>>,
}

/// Where a path has come to.
struct Path {
    random: PathRandom,
    inside: Inside,
    /// How many lights were drawn at its first surface for each direction that was.
    lights: LightsAPath,
}

/// How many directions of the sky and places on lamps are drawn for each direction that a surface scatters to.
#[derive(Clone, Copy)]
struct LightsAPath {
    sky: f64,
    lamps: f64,
}

impl LightsAPath {
    /// As many of either.
    fn each(lights: f64) -> Self {
        Self { sky: lights, lamps: lights }
    }

    /// Of what is drawn where this one is.
    fn of(&self, sample: &LightSample) -> f64 {
        if sample.is_of_sky() { self.sky } else { self.lamps }
    }
}

/// Light on its way back along a path: from where, in which direction, and how likely that was drawn.
#[derive(Clone, Copy)]
struct Step {
    from: SurfacePoint,
    position: DVec3,
    direction: DVec3,
    /// 1/sr; none where no light that is drawn could have been it.
    density: Option<f64>,
}

/// What of the scene's light is known.
#[derive(Clone, Copy)]
enum Known<'a> {
    Nothing,
    /// Where it will be.
    Patches(&'a Patches),
    All(&'a Irradiance),
}

/// A place that a path came to, where what arrives at diffuse lobes is known or will be.
struct Reached {
    place: Place,
    /// Irradiance/π there; 0 where it is not solved for yet.
    irradiance: Vec3,
}

/// What a path found.
struct Arriving {
    /// Light that came straight from where lights are drawn, too.
    drawn: DVec3,
    /// Other light.
    other: DVec3,
    /// How far the first surface is.
    distance: f64,
    /// Where what arrives at diffuse lobes is known, and what of that is sent on.
    onward: Option<(Reached, DVec3)>,
}

/// What a patch finds in one direction, as irradiance/π.
pub(crate) struct Found {
    pub drawn: Vec3,
    pub other: Vec3,
    pub distance: f64,
    /// Where more comes from, the share of it, and a uniform number.
    pub onward: Option<(Place, Vec3, f64)>,
}

/// After so many scatterings Russian roulette begins.
const SURE_SCATTERINGS: u32 = 3;
/// A surface that is nearer than so many patches is too near for them to tell.
const NEAR: f64 = 2.0;

impl Transport {
    /// Prepares the scene in `tracer` in a world.
    pub fn new(tracer: Arc<Tracer>, world: World, options: TransportOptions) -> Self {
        let scene = tracer.scene();
        let (lights, media) = (Lights::of(scene, &world), Media::of(scene));
        Self { tracer, world, options, lights, media, irradiance: None, sky: OnceLock::new() }
    }

    /// The same with light that is known already, of the same scene and world.
    pub fn with_irradiance(self, irradiance: Arc<Irradiance>) -> Self {
        Self { irradiance: Some(irradiance), ..self }
    }

    /// The scene it lights.
    pub(crate) fn scene(&self) -> &Scene {
        self.tracer.scene()
    }

    /// The world it stands in.
    pub(crate) fn world(&self) -> &World {
        &self.world
    }

    /// What one ray of a patch finds, `index` of those of the patch that begins with `seed`.
    pub(crate) fn look_around(
        &self,
        seed: SurfacePoint,
        from: PatchPoint,
        index: u32,
        patches: &Patches,
    ) -> Found {
        let scene = self.scene();
        let PatchPoint { point, is_front } = from;
        let place = Place::of(scene, point, is_front);
        let geometric = scene.area_normal(point.triangle).normalize_or_zero();
        let geometric = if is_front { geometric } else { -geometric };
        let at = MaterialPoint {
            position: place.position,
            surface: Surface { metallic: 0.0, specular: 0.0, ..Surface::default() },
            frame: Frame::new(geometric, place.normal, DVec3::ZERO),
            material: scene.parts[place.part as usize].material,
        };
        let inside = self.media.beside(at.material, is_front);
        let random = PathRandom::new(PathRandom::seed(seed, place.normal), index);
        let mut path = Path { random, inside, lights: LightsAPath::each(1.0) };
        let interface = self.media.interface(at.material, &inside, is_front);
        let bsdf = Bsdf::new(&at.surface, at.frame, interface);
        let lobes = bsdf.toward(place.normal);
        let mut found = Found {
            drawn: self.direct(point, &at, &lobes, &mut path).total().as_vec3(),
            other: Vec3::ZERO,
            distance: f64::INFINITY,
            onward: None,
        };
        if let Some(scattered) = lobes.sample(path.random.next3()) {
            let step = self.step(point, &at, &scattered, &mut path);
            let weight = scattered.weight.own;
            let arriving = self.arriving(step, &mut path, Known::Patches(patches));
            found.drawn += (weight * arriving.drawn).as_vec3();
            found.other = (weight * arriving.other).as_vec3();
            found.distance = arriving.distance;
            found.onward = arriving
                .onward
                .map(|(reached, share)| (reached.place, (weight * share).as_vec3(), path.random.next()));
        }
        found
    }

    /// What a surface scatters toward the eye of light that one path finds.
    fn scattered(
        &self,
        point: SurfacePoint,
        at: &MaterialPoint,
        outgoing: DVec3,
        path: &mut Path,
    ) -> Gathered {
        let dispersed = self.disperse(at, path);
        let is_front = at.frame.geometric.dot(outgoing) >= 0.0;
        let interface = self.media.interface(at.material, &path.inside, is_front);
        let bsdf = Bsdf::new(&at.surface, at.frame, interface);
        let lobes = bsdf.toward(outgoing);
        let mut sum = Gathered { light: self.direct(point, at, &lobes, path), by_chance: Split::default() };
        if let Some(scattered) = lobes.sample(path.random.next3()) {
            let step = self.step(point, at, &scattered, path);
            let Arriving { drawn, other, .. } = self.arriving(step, path, Known::Nothing);
            sum += Gathered::by(&scattered, drawn, other);
        }
        sum.split(dispersed)
    }

    /// Goes where a surface scatters, through it if it must.
    fn step(&self, from: SurfacePoint, at: &MaterialPoint, scattered: &Scattered, path: &mut Path) -> Step {
        if scattered.crosses {
            let enters = at.frame.geometric.dot(scattered.incident) < 0.0;
            self.media.cross(&mut path.inside, at.material, enters);
        }
        let (direction, density) = (scattered.incident, scattered.density);
        Step { from, position: at.position, direction, density }
    }

    /// Follows one colour from here on, where the glass bends each differently: its share of the light.
    fn disperse(&self, at: &MaterialPoint, path: &mut Path) -> DVec3 {
        if path.inside.channel.is_some()
            || !self.media.disperses(at.material)
            || at.surface.transmission <= 0.0
        {
            return DVec3::ONE;
        }
        let channel = ((path.random.next() * 3.0) as usize).min(2);
        path.inside.channel = Some(channel);
        DVec3::from_array(std::array::from_fn(|k| if k == channel { 3.0 } else { 0.0 }))
    }

    /// What lights that are drawn send by way of a surface.
    fn direct(
        &self,
        point: SurfacePoint,
        at: &MaterialPoint,
        lobes: &Toward<'_, '_>,
        path: &mut Path,
    ) -> Split {
        self.direct_by(point, at, path, true, |sample| {
            let (sent, own) = lobes.scatter(sample.from);
            sent * sample.density.map_or(1.0, |density| heuristic(density, own))
        })
    }

    /// The same by what is sent on of the light of a sample.
    fn direct_by(
        &self,
        point: SurfacePoint,
        at: &MaterialPoint,
        path: &mut Path,
        with_punctual: bool,
        send: impl Fn(&LightSample) -> Split,
    ) -> Split {
        let mut sum = Split::default();
        let (inside, random) = (path.inside, &mut path.random);
        self.lights.sample(
            self.scene(),
            &self.world,
            at.position,
            with_punctual,
            || random.next(),
            |sample: LightSample| {
                if sample.light == Vec3::ZERO {
                    return;
                }
                let sent = send(&sample);
                if sent.total() == DVec3::ZERO || self.tracer.occluded(point, sample.source) {
                    return;
                }
                sum += split(sent, self.light_of(&sample, at.position, &inside));
            },
        );
        sum
    }

    /// The light of a sample, past what absorbs it on the way to a position.
    fn light_of(&self, sample: &LightSample, position: DVec3, inside: &Inside) -> DVec3 {
        let way = if sample.is_near { position.distance(sample.source) } else { f64::INFINITY };
        sample.light.as_dvec3() * self.media.attenuation(inside, way)
    }

    /// What a lamp sends straight from a direction that was drawn with a density, less what lamps that are drawn tell of it.
    fn lamp_along(
        &self,
        from: SurfacePoint,
        position: DVec3,
        direction: DVec3,
        density: f64,
        path: &Path,
    ) -> DVec3 {
        let Some(hit) = self.tracer.first_met(from, direction) else { return DVec3::ZERO };
        let place = hit.point.position(self.scene());
        let of_light = self.lights.density_of_emitter(hit.point.triangle, place, position);
        if of_light == 0.0 {
            return DVec3::ZERO;
        }
        let share = heuristic(density, of_light * path.lights.lamps);
        let light = emitted(self.scene(), hit.point, -direction).as_dvec3() * share;
        light * self.media.attenuation(&path.inside, hit.t)
    }

    /// The radiance that arrives along a step, and all that comes after it as far as it is not known.
    fn arriving(&self, mut step: Step, path: &mut Path, known: Known<'_>) -> Arriving {
        let scene = self.scene();
        let most = self.world.bounces.unwrap_or(u32::MAX);
        let mut found =
            Arriving { drawn: DVec3::ZERO, other: DVec3::ZERO, distance: f64::INFINITY, onward: None };
        let mut throughput = DVec3::ONE;
        let mut widest = step.density;
        for scatterings in 1u32.. {
            let hit = self.tracer.first_met(step.from, step.direction);
            let length = hit.map_or(f64::INFINITY, |hit| hit.t);
            throughput *= self.media.attenuation(&path.inside, length);
            let Some(Hit { point, t }) = hit else {
                let of_light = self.lights.density_of_environment(&self.world, step.direction);
                let light = throughput * self.world.radiance(step.direction).as_dvec3();
                let often = path.lights.sky;
                found.add(light, step.density, [of_light, often], scatterings);
                return found;
            };
            if scatterings == 1 {
                found.distance = t;
            }
            let outgoing = -step.direction;
            let shines = emitted(scene, point, outgoing).as_dvec3();
            if shines != DVec3::ZERO {
                let place = point.position(scene);
                let of_light = self.lights.density_of_emitter(point.triangle, place, step.position);
                let often = path.lights.lamps;
                found.add(throughput * shines, step.density, [of_light, often], scatterings);
            }
            if scatterings > most || scene.material_of(point.triangle).unlit {
                return found;
            }
            let mut at = MaterialPoint::of(scene, point, self.options.scattering);
            if let (Known::All(_), Some(density)) = (known, widest) {
                at.surface = at.surface.no_sharper_than(as_seen_by(density));
            }
            throughput *= self.disperse(&at, path);
            let is_front = at.frame.geometric.dot(outgoing) >= 0.0;
            let interface = self.media.interface(at.material, &path.inside, is_front);
            let bsdf = Bsdf::new(&at.surface, at.frame, interface);
            let lobes = bsdf.toward(outgoing);
            let scattered = match known.reached(scene, point, is_front, t) {
                None => {
                    found.other += throughput * self.direct(point, &at, &lobes, path).total();
                    let Some(scattered) = lobes.sample(path.random.next3()) else { return found };
                    throughput *= scattered.weight.total();
                    scattered
                }
                Some(reached) => {
                    // What is own is known; what is carried is followed.
                    let Split { own, carried } = lobes.albedo();
                    let [of_own, of_carried] = [own, carried].map(DVec3::element_sum);
                    if of_carried > 0.0 {
                        found.other += throughput * self.direct(point, &at, &lobes, path).carried;
                    }
                    let ends = of_own / (of_own + of_carried);
                    if of_carried == 0.0 || path.random.next() < ends {
                        let share = if of_carried == 0.0 { 1.0 } else { ends };
                        found.onward = (of_own > 0.0).then_some((reached, throughput * own / share));
                        return found;
                    }
                    let Some(scattered) = lobes.sample_sharp(path.random.next3()) else { return found };
                    throughput *= scattered.weight.carried / (1.0 - ends);
                    scattered
                }
            };
            if scatterings >= SURE_SCATTERINGS || throughput == DVec3::ZERO {
                let lives = throughput.max_element().min(0.95);
                if path.random.next() >= lives {
                    return found;
                }
                throughput /= lives;
            }
            step = self.step(point, &at, &scattered, path);
            widest = match (widest, step.density) {
                (Some(so_far), Some(density)) => Some(so_far.min(density)),
                (so_far, density) => so_far.or(density),
            };
        }
        found
    }
}

impl Arriving {
    /// Light that was found after so many scatterings by a direction of some density; lights find it with another, and are drawn
    /// so often for the first direction.
    fn add(&mut self, light: DVec3, density: Option<f64>, [of_light, often]: [f64; 2], scatterings: u32) {
        let drawn = if scatterings == 1 { of_light * often } else { of_light };
        let light = light * density.map_or(1.0, |own| heuristic(own, drawn));
        let sum = if scatterings == 1 && of_light > 0.0 { &mut self.drawn } else { &mut self.other };
        *sum += light;
    }
}

impl Known<'_> {
    /// A place that a path came to over a distance, if what arrives there is known.
    fn reached(self, scene: &Scene, point: SurfacePoint, is_front: bool, distance: f64) -> Option<Reached> {
        let spacing = match self {
            Self::Nothing => return None,
            Self::Patches(patches) => patches.spacing(),
            Self::All(irradiance) => irradiance.spacing(),
        };
        if distance < NEAR * spacing {
            return None;
        }
        let place = Place::of(scene, point, is_front);
        let irradiance = match self {
            Self::Nothing => None,
            Self::Patches(patches) => patches.knows(&place).then_some(Vec3::ZERO),
            Self::All(irradiance) => irradiance.total(&place),
        };
        irradiance.map(|irradiance| Reached { place, irradiance })
    }
}

/// How many of `wanted` each of so many points takes, whose mean is wanted: as many as it would alone, up to four points.
fn each_of(among: Among, wanted: u32) -> u32 {
    const ALONE: u32 = 4;
    (wanted * ALONE).div_ceil(among.count.max(ALONE)).max(1)
}

/// How rough what is reflected may be taken for, perceptually, where a lobe reflects it that is so wide: of a density, 1/sr, in the
/// direction it was drawn in. A lamp in a mirror in rough metal is then found by drawing lamps, and not by chance, for a little
/// blur of what is blurred anyway (path space regularisation, Kaplanyan and Dachsbacher 2013; the widths are those of Cycles).
fn as_seen_by(density: f64) -> f64 {
    let alpha = 0.5 * (1.0 - density).max(0.0).sqrt();
    alpha.sqrt()
}

/// The share of a way of sampling with density `own` in what another with density `other` finds as well (Veach and Guibas 1995,
/// the power heuristic): own²/(own² + other²).
fn heuristic(own: f64, other: f64) -> f64 {
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

impl Radiance for Transport {
    fn leaving(&self, point: SurfacePoint, eye: DVec3) -> Leaving {
        self.leaving_among(point, eye, Among::alone(PathRandom::seed(point, eye)))
    }

    fn leaving_among(&self, point: SurfacePoint, eye: DVec3, among: Among) -> Leaving {
        let scene = self.scene();
        let outgoing = (eye - point.position(scene)).normalize_or_zero();
        let emitted = emitted(scene, point, outgoing);
        if scene.material_of(point.triangle).unlit || outgoing == DVec3::ZERO {
            return Leaving::own(emitted);
        }
        let at = MaterialPoint::of(scene, point, self.options.scattering);
        let is_front = at.frame.geometric.dot(outgoing) >= 0.0;
        let inside = self.media.beside(at.material, is_front);
        let interface = self.media.interface(at.material, &inside, is_front);
        let bsdf = Bsdf::new(&at.surface, at.frame, interface);
        let lobes = bsdf.toward(outgoing);
        let known = self.irradiance.as_deref().and_then(|known| {
            let irradiance = match among.received {
                Some(received) => known.received(&self.world, &received, lobes.normal()),
                None => known.indirect(&Place::of(scene, point, is_front))?.as_dvec3(),
            };
            Some((known, irradiance))
        });
        let Gathered { light, by_chance } = match known {
            Some((known, irradiance)) => {
                let spread = lobes.spread_albedo();
                let Split { own, carried } = lobes.albedo();
                let gloss = among.received.and_then(|received| received.gloss);
                let told = irradiance * spread
                    + gloss.map_or(DVec3::ZERO, |gloss| gloss.as_dvec3() * (own - spread).max(DVec3::ZERO));
                let asks = match (among.received, gloss) {
                    (None, _) => true,
                    (Some(_), None) => !lobes.is_spread(),
                    (Some(_), Some(_)) => !among.own_only && carried != DVec3::ZERO,
                };
                let mut beside = match asks {
                    true => self.scattered_beside(point, &at, (&lobes, outgoing), inside, (known, among)),
                    false => Gathered::default(),
                };
                beside.light += Split { own: told, carried: DVec3::ZERO };
                beside
            }
            None => {
                let paths = each_of(among, self.options.paths);
                let mut sum = Gathered::default();
                for index in 0..paths {
                    let random = PathRandom::new(among.seed, among.index * paths + index);
                    let mut path = Path { random, inside, lights: LightsAPath::each(1.0) };
                    sum += self.scattered(point, &at, outgoing, &mut path);
                }
                sum * (1.0 / f64::from(paths))
            }
        };
        let [_, carried_share] = lobes.coverage_shares();
        Leaving {
            own: emitted + light.own.as_vec3(),
            carried: light.carried.as_vec3(),
            carried_share: carried_share as f32,
            by_chance: [by_chance.own, by_chance.carried].map(|light| light.as_vec3()),
        }
    }

    fn received(&self, spots: &[Spot], eye: DVec3) -> Vec<Option<Received>> {
        self.receive(spots, eye)
    }

    fn varies_within(&self, point: SurfacePoint) -> bool {
        let scene = self.scene();
        let material = scene.material_of(point.triangle);
        material.unlit || !scene.colors.is_empty() || material.has_textures()
    }

    fn carried_width(&self, point: SurfacePoint) -> Option<f64> {
        let scene = self.scene();
        if scene.material_of(point.triangle).unlit {
            return None;
        }
        MaterialPoint::of(scene, point, self.options.scattering).surface.carried_width()
    }

    fn from_infinity(&self, direction: DVec3) -> Vec3 {
        self.world.seen(direction.normalize_or_zero())
    }
}

#[cfg(test)]
mod tests;
