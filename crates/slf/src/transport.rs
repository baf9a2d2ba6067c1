//! Light transport by path tracing: emitted light, and light scattered between surfaces.

mod batch_measurement;
pub(crate) mod irradiance_lookup;
mod patch_gathering;
pub(crate) mod patch_rays;
mod path_tracing;
mod scattered_light;
mod uncached_light;

use crate::bounce_limit::BounceLimit;
use crate::irradiance::Irradiance;
use crate::irradiance::place::Place;
use crate::lights::{LightSample, Lights};
use crate::material_point::{MaterialPoint, emitted};
use crate::media::{Media, MediumStack};
use crate::path_random::PathRandom;
use glam::{DVec3, Vec3};
use irradiance_lookup::{CacheMode, IrradianceLookup};
use material::{Bsdf, OutgoingBsdf, Parts, Scattered, Scattering, Split};
use scattered_light::{ScatteredLight, max_split, scale_split};
use scene::{Scene, SurfacePoint, World};
use std::sync::{Arc, OnceLock};
use trace::{IncidentLight, OutgoingRadiance, Radiance, SampleSlot, ShadingPoint, Tracer};

/// Sampling effort and scattering model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TransportOptions {
    /// Paths per point and eye; fewer where only the mean of many points matters ([`Radiance::outgoing_sample`]). Their
    /// noise is that of a picture that evaluates each surface point once; where many points share a pixel, as in the
    /// ground truth, one will do.
    pub paths: u32,
    /// Light samples per point and eye where irradiance is cached; elsewhere each path takes one.
    pub light_samples: u32,
    /// Whether light that scatters more than once between microfacets counts.
    pub scattering: Scattering,
}

impl Default for TransportOptions {
    fn default() -> Self {
        Self { paths: 32, light_samples: 16, scattering: Scattering::Multiple }
    }
}

/// Radiance of a lit scene by path tracing (Kajiya 1986).
///
/// | surface | radiance |
/// | --- | --- |
/// | unlit | its base colour, on both sides; for a picture's surface + the view-dependent change found in other views |
/// | emissive | the emitted radiance, on the front; on both sides if double sided |
/// | any but unlit | + incident light scattered by its lobes ([`Bsdf`]) |
///
/// At every surface a path meets, two techniques are combined by the power heuristic (Veach and Guibas 1995): light
/// sampling (an emissive triangle by the share of its power that may arrive, a direction of the environment by its
/// brightness; punctual lights all, or one by the light it would send) and BSDF sampling. Unlit surfaces send the
/// colour they show and are found by BSDF sampling alone. Paths end by Russian roulette or after the world's bounces.
/// Nothing else is left out or clamped, so the mean over points and paths is exact and depends on the point and the eye
/// alone.
///
/// With cached [`Irradiance`] a path ends at the next diffuse surface, and the indirect light of the point's own
/// diffuse lobes is looked up as well. That is much faster, at the cost of the error of interpolation between patches.
/// To remove that error ([`Self::with_control_variate`]), the cache serves as a control variate: paths still end there,
/// but randomly chosen ones go on and correct for the difference they find.
pub struct Transport {
    tracer: Arc<Tracer>,
    world: World,
    options: TransportOptions,
    lights: Lights,
    media: Media,
    cache_mode: CacheMode,
    bounce_limit: BounceLimit,
    /// Whether any surface receives light.
    is_lit: bool,
    /// Directions of the sky, sampled on first use.
    sky_samples: OnceLock<Vec<LightSample>>,
}

/// State of a path.
struct Path {
    random: PathRandom,
    inside: MediumStack,
    /// Light samples taken at its first surface per sampled direction.
    lights: LightsPerDirection,
}

/// Light samples of the sky and of emitters per direction sampled from the BSDF.
#[derive(Clone, Copy)]
struct LightsPerDirection {
    sky: f64,
    emitters: f64,
}

impl LightsPerDirection {
    /// The same number of either.
    fn uniform(lights: f64) -> Self {
        Self { sky: lights, emitters: lights }
    }

    /// The number for the kind of light of this sample.
    fn for_sample(&self, sample: &LightSample) -> f64 {
        if sample.is_sky() { self.sky } else { self.emitters }
    }
}

/// One step along a path, from a surface in a direction.
#[derive(Clone, Copy)]
struct Step {
    origin: SurfacePoint,
    position: DVec3,
    direction: DVec3,
    /// Density of the direction, 1/sr; `None` if no light sample could have produced it.
    density: Option<f64>,
}

impl Transport {
    /// Prepares to trace light paths in the scene of `tracer`, lit by `world`. No irradiance is cached.
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
            bounce_limit: BounceLimit::default(),
            is_lit,
            sky_samples: OnceLock::new(),
        }
    }

    /// Records in `limit` whether a path was cut off after [`MAX_BOUNCES`](crate::MAX_BOUNCES).
    pub fn with_bounce_limit(self, limit: BounceLimit) -> Self {
        Self { bounce_limit: limit, ..self }
    }

    /// Uses cached irradiance of the same scene and world, trusting it: paths end on it. Fast, with the cache's
    /// error.
    pub fn with_irradiance(self, irradiance: Arc<Irradiance>) -> Self {
        Self { cache_mode: CacheMode::Trusted(irradiance), ..self }
    }

    /// Uses cached irradiance of the same scene and world as a control variate: some paths go on past it and correct
    /// its error. The mean over points and paths is therefore as exact as without the cache, whatever it holds; the
    /// noise is that of [`TransportOptions::paths`].
    pub fn with_control_variate(self, irradiance: Arc<Irradiance>) -> Self {
        Self { cache_mode: CacheMode::ControlVariate(irradiance), ..self }
    }

    /// The lit scene.
    pub fn scene(&self) -> &Arc<Scene> {
        self.tracer.scene()
    }

    /// The world around the scene.
    pub(crate) fn world(&self) -> &World {
        &self.world
    }

    /// Light scattered toward the eye, found by one path.
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
            let path_light = self.trace_path(step, path, lookup);
            sum += ScatteredLight::from_direction(
                &scattered,
                path_light.direct + path_light.cached_light(),
                path_light.indirect,
            );
        }
        sum.scaled(dispersed)
    }

    /// Continues a path in a sampled direction, through the surface if the direction crosses it.
    fn step(&self, origin: SurfacePoint, at: &MaterialPoint, scattered: &Scattered, path: &mut Path) -> Step {
        if scattered.crosses {
            let enters = at.frame.geometric.dot(scattered.incident) < 0.0;
            self.media.cross(&mut path.inside, at.material, enters);
        }
        let (direction, density) = (scattered.incident, scattered.density);
        Step { origin, position: at.position, direction, density }
    }

    /// Where glass disperses, continues with a single colour channel; returns its weight.
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

    /// Scattered light of sampled lights, with the weights of multiple importance sampling.
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

    /// The carried part of it, as far as BSDF sampling of the sharp lobes alone does not find it.
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

    /// Sums the sampled lights that are not occluded; `send` returns what is scattered of the light of a sample.
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

    /// Light of a sample after absorption on the way to a position.
    fn attenuated_light(&self, sample: &LightSample, position: DVec3, inside: &MediumStack) -> DVec3 {
        let distance = if sample.is_near { position.distance(sample.source) } else { f64::INFINITY };
        sample.light.as_dvec3() * self.media.attenuation(inside, distance)
    }

    /// Light of an emitter hit in a direction sampled with `density`, weighted against light sampling.
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
        let share = power_heuristic(density, light_density * path.lights.emitters);
        let light = emitted(self.scene(), hit.point, -direction).as_dvec3() * share;
        light * self.media.attenuation(&path.inside, hit.t)
    }
}

/// How many of `requested` samples each point takes if only the mean of a batch matters: all of them for up to four
/// points, fewer beyond.
fn samples_per_point(slot: SampleSlot, requested: u32) -> u32 {
    const FULL_SAMPLING_POINTS: u32 = 4;
    (requested * FULL_SAMPLING_POINTS).div_ceil(slot.count.max(FULL_SAMPLING_POINTS)).max(1)
}

/// Power heuristic (Veach and Guibas 1995): weight of a technique with density `own` beside another with density
/// `other`, own²/(own² + other²).
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
                Some(incident) => cached.shaded(&self.world, &incident, lobes.normal()),
                None => cached.indirect(self, &Place::new(scene, point, is_front))?.as_dvec3(),
            };
            Some((cached, irradiance))
        });
        let ScatteredLight { light, noisy } = match cached {
            Some((cache, irradiance)) => {
                let spread = lobes.spread_albedo();
                let Split { own, carried } = lobes.albedo();
                let gloss = slot.incident.and_then(|incident| incident.gloss);
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
                // Another number of paths uses another seed, so that the difference of two means shows their noise.
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
                    // The mean of many paths is not noisy, but one path that found more than all others may be.
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

    fn incident_batch(&self, points: &[ShadingPoint], eye: DVec3) -> Vec<Option<IncidentLight>> {
        self.measure_batch(points, eye)
    }

    fn varies_within_pixel(&self, point: SurfacePoint) -> bool {
        let scene = self.scene();
        let material = scene.material_of(point.triangle);
        // If few points stood for all, the mean would not be exact.
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
        /// In apertures of the captured light field: eight cells make one.
        const CAPTURED_APERTURES: f64 = 0.75;
        self.scene().picture_gloss_angle(point).map(|angle| CAPTURED_APERTURES * angle)
    }

    fn environment(&self, direction: DVec3) -> Vec3 {
        self.world.backdrop_radiance(direction.normalize_or_zero())
    }
}

#[cfg(test)]
mod tests;
