//! Light transport: what surfaces send by themselves and what they scatter of each other's light, by paths.

mod beside;
mod following;
mod gathered;
mod known;
mod receiving;

use crate::irradiance::Irradiance;
use crate::irradiance::patches::{PatchPoint, Patches};
use crate::irradiance::place::Place;
use crate::lights::{LightSample, Lights};
use crate::material_point::{MaterialPoint, emitted};
use crate::media::{Media, MediumStack};
use crate::path_random::PathRandom;
use gathered::{ScatteredLight, max_split, scale_split};
use glam::{DVec3, Vec3};
use known::{CacheMode, IrradianceLookup};
use material::{Bsdf, Frame, OutgoingBsdf, Parts, Scattered, Scattering, Split, Surface};
use scene::{Scene, SurfacePoint, World};
use std::sync::{Arc, OnceLock};
use trace::{IncidentLight, OutgoingRadiance, Radiance, SampleSlot, ShadingPoint, Tracer};

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
/// | unlit | its base colour, on both sides; of a picture's surface + what views showed otherwise from elsewhere |
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
/// their mean stands for every point of them. Where that is to be refined ([`Self::checking`]), what is known is a control variate:
/// paths end there, too, but some of them, drawn by chance, go on and count for all by how far off they found it.
pub struct Transport {
    tracer: Arc<Tracer>,
    world: World,
    options: TransportOptions,
    lights: Lights,
    media: Media,
    cache_mode: CacheMode,
    /// Whether any surface receives light.
    is_lit: bool,
    /// Directions of the sky, once they are asked for.
    sky_samples: OnceLock<Vec<LightSample>>,
}

/// Where a path has come to.
struct Path {
    random: PathRandom,
    inside: MediumStack,
    /// How many lights were drawn at its first surface for each direction that was.
    lights: LightsPerDirection,
}

/// How many directions of the sky and places on lamps are drawn for each direction that a surface scatters to.
#[derive(Clone, Copy)]
struct LightsPerDirection {
    sky: f64,
    lamps: f64,
}

impl LightsPerDirection {
    /// As many of either.
    fn uniform(lights: f64) -> Self {
        Self { sky: lights, lamps: lights }
    }

    /// Of what is drawn where this one is.
    fn for_sample(&self, sample: &LightSample) -> f64 {
        if sample.is_sky() { self.sky } else { self.lamps }
    }
}

/// Light on its way back along a path: from where, in which direction, and how likely that was drawn.
#[derive(Clone, Copy)]
struct Step {
    origin: SurfacePoint,
    position: DVec3,
    direction: DVec3,
    /// 1/sr; none where no light that is drawn could have been it.
    density: Option<f64>,
}

/// What a patch finds in one direction, as irradiance/π.
pub(crate) struct PatchRay {
    pub direct: Vec3,
    pub indirect: Vec3,
    pub distance: f64,
    /// Where more comes from, the share of it, and a uniform number.
    pub link: Option<(Place, Vec3, f64)>,
}

impl Transport {
    /// Prepares the scene in `tracer` in a world.
    pub fn new(tracer: Arc<Tracer>, world: World, options: TransportOptions) -> Self {
        let scene = tracer.scene();
        let (lights, media) = (Lights::new(scene, &world), Media::from_scene(scene));
        let is_lit = scene.parts.iter().any(|part| !scene.materials[part.material as usize].unlit);
        Self {
            tracer,
            world,
            options,
            lights,
            media,
            cache_mode: CacheMode::Disabled,
            is_lit,
            sky_samples: OnceLock::new(),
        }
    }

    /// The same with light that is known already, of the same scene and world.
    pub fn with_irradiance(self, irradiance: Arc<Irradiance>) -> Self {
        Self { cache_mode: CacheMode::Trusted(irradiance), ..self }
    }

    /// The same with light that is known but not trusted: what it tells is used, and one path of a few checks it by going on to the
    /// end. So the mean over points and paths is exact, as without it, whatever it tells; the noise is that of
    /// [`TransportOptions::paths`].
    pub fn with_control_variate(self, irradiance: Arc<Irradiance>) -> Self {
        Self { cache_mode: CacheMode::ControlVariate(irradiance), ..self }
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
    pub(crate) fn trace_patch_ray(
        &self,
        seed: SurfacePoint,
        from: PatchPoint,
        index: u32,
        patches: &Patches,
    ) -> PatchRay {
        let scene = self.scene();
        let PatchPoint { point, is_front } = from;
        let place = Place::new(scene, point, is_front);
        let geometric = scene.area_normal(point.triangle).normalize_or_zero();
        let geometric = if is_front { geometric } else { -geometric };
        let at = MaterialPoint {
            position: place.position,
            surface: Surface { metallic: 0.0, specular: 0.0, ..Surface::default() },
            frame: Frame::new(geometric, place.normal, DVec3::ZERO),
            material: scene.parts[place.part as usize].material,
        };
        let inside = self.media.outgoing_medium(at.material, is_front);
        let random = PathRandom::new(PathRandom::seed(seed, place.normal), index);
        let mut path = Path { random, inside, lights: LightsPerDirection::uniform(1.0) };
        let interface = self.media.interface(at.material, &inside, is_front);
        let bsdf = Bsdf::new(&at.surface, at.frame, interface);
        let lobes = bsdf.toward(place.normal);
        let mut ray = PatchRay {
            direct: self.direct(point, &at, &lobes, &mut path).total().as_vec3(),
            indirect: Vec3::ZERO,
            distance: f64::INFINITY,
            link: None,
        };
        if let Some(scattered) = lobes.sample(path.random.next3()) {
            let step = self.step(point, &at, &scattered, &mut path);
            let weight = scattered.weight.own;
            let incident = self.trace_path(step, &mut path, IrradianceLookup::Unsolved(patches));
            ray.direct += (weight * incident.direct).as_vec3();
            ray.indirect = (weight * incident.indirect).as_vec3();
            ray.distance = incident.distance;
            ray.link = incident
                .cached_end
                .map(|(reached, share)| (reached.place, (weight * share).as_vec3(), path.random.next()));
        }
        ray
    }

    /// What a surface scatters toward the eye of light that one path finds.
    fn scatter_path(
        &self,
        point: SurfacePoint,
        at: &MaterialPoint,
        outgoing: DVec3,
        path: &mut Path,
        lookup: IrradianceLookup<'_>,
    ) -> ScatteredLight {
        let dispersed = self.disperse(at, path);
        let is_front = at.frame.geometric.dot(outgoing) >= 0.0;
        let interface = self.media.interface(at.material, &path.inside, is_front);
        let bsdf = Bsdf::new(&at.surface, at.frame, interface);
        let lobes = bsdf.toward(outgoing);
        let mut sum = ScatteredLight { light: self.direct(point, at, &lobes, path), noisy: Split::default() };
        if let Some(scattered) = lobes.sample(path.random.next3()) {
            let step = self.step(point, at, &scattered, path);
            let incident = self.trace_path(step, path, lookup);
            sum += ScatteredLight::from_direction(
                &scattered,
                incident.direct + incident.cached_light(),
                incident.indirect,
            );
        }
        sum.scaled(dispersed)
    }

    /// Goes where a surface scatters, through it if it must.
    fn step(&self, origin: SurfacePoint, at: &MaterialPoint, scattered: &Scattered, path: &mut Path) -> Step {
        if scattered.crosses {
            let enters = at.frame.geometric.dot(scattered.incident) < 0.0;
            self.media.cross(&mut path.inside, at.material, enters);
        }
        let (direction, density) = (scattered.incident, scattered.density);
        Step { origin, position: at.position, direction, density }
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
        lobes: &OutgoingBsdf<'_, '_>,
        path: &mut Path,
    ) -> Split {
        self.sum_direct(point, at, path, true, |sample| {
            let (sent, own) = lobes.scatter(sample.direction);
            sent * sample.density.map_or(1.0, |density| power_heuristic(density, own))
        })
    }

    /// What of it is carried, as far as drawing a direction for sharp lobes alone does not find it.
    fn direct_carried(
        &self,
        point: SurfacePoint,
        at: &MaterialPoint,
        lobes: &OutgoingBsdf<'_, '_>,
        path: &mut Path,
    ) -> DVec3 {
        let sent = self.sum_direct(point, at, path, true, |sample| {
            let (Parts { sharp, .. }, own) = lobes.scatter_parts(sample.direction);
            let share = sample.density.map_or(1.0, |density| power_heuristic(density, own));
            Split { own: DVec3::ZERO, carried: sharp.carried * share }
        });
        sent.carried
    }

    /// The same by what is sent on of the light of a sample.
    fn sum_direct(
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
                if sent.total() == DVec3::ZERO || self.tracer.is_occluded(point, sample.source) {
                    return;
                }
                sum += scale_split(sent, self.attenuated_light(&sample, at.position, &inside));
            },
        );
        sum
    }

    /// The light of a sample, past what absorbs it on the way to a position.
    fn attenuated_light(&self, sample: &LightSample, position: DVec3, inside: &MediumStack) -> DVec3 {
        let distance = if sample.is_near { position.distance(sample.source) } else { f64::INFINITY };
        sample.light.as_dvec3() * self.media.attenuation(inside, distance)
    }

    /// What a lamp sends straight from a direction that was drawn with a density, less what lamps that are drawn tell of it.
    fn emitter_light_along(
        &self,
        from: SurfacePoint,
        position: DVec3,
        direction: DVec3,
        density: f64,
        path: &Path,
    ) -> DVec3 {
        let Some(hit) = self.tracer.first_hit_from(from, direction) else { return DVec3::ZERO };
        let place = hit.point.position(self.scene());
        let light_density = self.lights.emitter_density(hit.point.triangle, place, position);
        if light_density == 0.0 {
            return DVec3::ZERO;
        }
        let share = power_heuristic(density, light_density * path.lights.lamps);
        let light = emitted(self.scene(), hit.point, -direction).as_dvec3() * share;
        light * self.media.attenuation(&path.inside, hit.t)
    }
}

/// How many of `wanted` each of so many points takes, whose mean is wanted: as many as it would alone, up to four points.
fn samples_per_point(slot: SampleSlot, requested: u32) -> u32 {
    const FULL_SAMPLING_POINTS: u32 = 4;
    (requested * FULL_SAMPLING_POINTS).div_ceil(slot.count.max(FULL_SAMPLING_POINTS)).max(1)
}

/// The share of a way of sampling with density `own` in what another with density `other` finds as well (Veach and Guibas 1995,
/// the power heuristic): own²/(own² + other²).
fn power_heuristic(own: f64, other: f64) -> f64 {
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

impl Radiance for Transport {
    fn outgoing(&self, point: SurfacePoint, eye: DVec3) -> OutgoingRadiance {
        self.outgoing_sample(point, eye, SampleSlot::single(PathRandom::seed(point, eye)))
    }

    fn outgoing_sample(&self, point: SurfacePoint, eye: DVec3, slot: SampleSlot) -> OutgoingRadiance {
        let scene = self.scene();
        if scene.material_of(point.triangle).unlit {
            return OutgoingRadiance::from_own(
                (scene.emitted_radiance(point) + scene.picture_gloss_radiance(point, eye)).max(Vec3::ZERO),
            );
        }
        let outgoing = (eye - point.position(scene)).normalize_or_zero();
        let emitted = emitted(scene, point, outgoing);
        if outgoing == DVec3::ZERO {
            return OutgoingRadiance::from_own(emitted);
        }
        let at = MaterialPoint::new(scene, point, self.options.scattering);
        let is_front = at.frame.geometric.dot(outgoing) >= 0.0;
        let inside = self.media.outgoing_medium(at.material, is_front);
        let interface = self.media.interface(at.material, &inside, is_front);
        let bsdf = Bsdf::new(&at.surface, at.frame, interface);
        let lobes = bsdf.toward(outgoing);
        let cached = self.cache_mode.trusted().and_then(|cached| {
            let irradiance = match slot.incident {
                Some(received) => cached.shaded(&self.world, &received, lobes.normal()),
                None => cached.indirect(&Place::new(scene, point, is_front))?.as_dvec3(),
            };
            Some((cached, irradiance))
        });
        let ScatteredLight { light, noisy } = match cached {
            Some((cache, irradiance)) => {
                let spread = lobes.spread_albedo();
                let Split { own, carried } = lobes.albedo();
                let gloss = slot.incident.and_then(|received| received.gloss);
                let interpolated = irradiance * spread
                    + gloss.map_or(DVec3::ZERO, |gloss| gloss.as_dvec3() * (own - spread).max(DVec3::ZERO));
                let needs_tracing = match (slot.incident, gloss) {
                    (None, _) => true,
                    (Some(_), None) => !lobes.is_spread(),
                    (Some(_), Some(_)) => !slot.own_only && carried != DVec3::ZERO,
                };
                let mut traced = match needs_tracing {
                    true => self.trace_uncached(point, &at, (&lobes, outgoing), inside, (cache, slot)),
                    false => ScatteredLight::default(),
                };
                traced.light += Split { own: interpolated, carried: DVec3::ZERO };
                traced
            }
            None => {
                let paths = samples_per_point(slot, self.options.paths);
                let lookup = self
                    .cache_mode
                    .control_variate()
                    .map_or(IrradianceLookup::Unavailable, IrradianceLookup::ControlVariate);
                // Of another number of paths all are others: how far two means are apart tells their noise.
                let seed =
                    if lookup.is_control_variate() { slot.seed ^ u64::from(paths) << 1 } else { slot.seed };
                let mut sum = ScatteredLight::default();
                let mut max_noisy = Split::default();
                for index in 0..paths {
                    let random = PathRandom::new(seed, slot.index * paths + index);
                    let mut path = Path { random, inside, lights: LightsPerDirection::uniform(1.0) };
                    let path_light = self.scatter_path(point, &at, outgoing, &mut path, lookup);
                    max_noisy = max_split(max_noisy, path_light.noisy);
                    sum += path_light;
                }
                if lookup.is_control_variate() {
                    // Many paths together are no chance: one that found more than all others may be.
                    sum.noisy = max_noisy;
                }
                sum * (1.0 / f64::from(paths))
            }
        };
        let [_, carried_share] = lobes.coverage_shares();
        OutgoingRadiance {
            own: emitted + light.own.as_vec3(),
            carried: light.carried.as_vec3(),
            carried_share: carried_share as f32,
            noisy: [noisy.own, noisy.carried].map(|light| light.as_vec3()),
        }
    }

    fn supports_batches(&self) -> bool {
        self.is_lit && self.cache_mode.trusted().is_some()
    }

    fn incident_batch(&self, spots: &[ShadingPoint], eye: DVec3) -> Vec<Option<IncidentLight>> {
        self.measure_batch(spots, eye)
    }

    fn varies_within_pixel(&self, point: SurfacePoint) -> bool {
        let scene = self.scene();
        let material = scene.material_of(point.triangle);
        // Where few points would be taken for all, the mean would not be exact.
        let is_exact = self.cache_mode.control_variate().is_some();
        is_exact || material.unlit || !scene.colors.is_empty() || material.has_textures()
    }

    fn carried_lobe_width(&self, point: SurfacePoint) -> Option<f64> {
        let scene = self.scene();
        if scene.material_of(point.triangle).unlit {
            return None;
        }
        MaterialPoint::new(scene, point, self.options.scattering).surface.carried_width()
    }

    fn own_lobe_width(&self, point: SurfacePoint) -> Option<f64> {
        /// Angles of the captured aperture: eight cells of a light field are one.
        const CAPTURED_APERTURES: f64 = 0.75;
        self.scene().picture_gloss_angle(point).map(|angle| CAPTURED_APERTURES * angle)
    }

    fn environment(&self, direction: DVec3) -> Vec3 {
        self.world.backdrop_radiance(direction.normalize_or_zero())
    }
}

#[cfg(test)]
mod tests;
