//! Light that arrives at the points of a patch.

use super::irradiance_lookup::IrradianceLookup;
use super::{LightsPerDirection, Path, Step, Transport, power_heuristic};
use crate::irradiance::patches::PatchPoint;
use crate::irradiance::place::Place;
use crate::lights::LightSample;
use crate::material_point::emitted;
use crate::media::MediumStack;
use crate::path_random::PathRandom;
use glam::{DVec3, Vec3};
use material::Lambertian;
use scene::SurfacePoint;

/// A point of a patch, prepared for light that arrives there.
pub(crate) struct Receiver {
    point: SurfacePoint,
    position: DVec3,
    surface: Lambertian,
    inside: MediumStack,
}

/// Light other than that of sampled lights that one ray of a patch found, as irradiance/π.
pub(crate) struct IndirectRay {
    /// Without that of the link.
    pub light: Vec3,
    /// Distance to the first surface, infinite if there is none.
    pub distance: f64,
    pub link: Option<PatchRayLink>,
}

/// Where the ray of a patch ended at another patch.
#[derive(Clone, Copy)]
pub(crate) struct PatchRayLink {
    /// The place whose irradiance is passed on.
    pub place: Place,
    /// Irradiance/π there; 0 while it is still being solved.
    pub irradiance: Vec3,
    /// The share of it that is passed on.
    pub weight: Vec3,
    /// The product of the albedos along the ray, which the mean weight of all rays must not exceed.
    pub albedo: DVec3,
    /// Uniform number in [0, 1) that chooses among the patches around the place.
    pub choice: f64,
}

impl Transport {
    /// Prepares a point of a patch.
    pub(crate) fn receiver(&self, PatchPoint { point, is_front }: PatchPoint) -> Receiver {
        let scene = self.scene();
        let place = Place::new(scene, point, is_front);
        let geometric = scene.area_normal(point.triangle).normalize_or_zero();
        let surface = Lambertian::new(if is_front { geometric } else { -geometric }, place.normal);
        let material = scene.parts[place.part as usize].material;
        Receiver {
            point,
            position: place.position,
            surface,
            inside: self.media.outgoing_medium(material, is_front),
        }
    }

    /// Irradiance/π from sampled lights, by one sample of each kind of light and one direction.
    pub(crate) fn arriving_direct(&self, receiver: &Receiver, mut random: PathRandom) -> Vec3 {
        let Receiver { point, position, surface, inside } = receiver;
        let mut sum = DVec3::ZERO;
        let direction = random.next2();
        self.lights.sample(
            self.scene(),
            *position,
            true,
            || random.next(),
            |sample: LightSample| {
                let (scattered, own) = surface.scatter(sample.direction);
                if scattered == 0.0
                    || sample.light == Vec3::ZERO
                    || self.tracer.is_occluded(*point, sample.source)
                {
                    return;
                }
                let share = sample.density.map_or(1.0, |density| power_heuristic(density, own));
                sum += self.attenuated_light(&sample, *position, inside) * (scattered * share);
            },
        );
        if self.lights.has_areas()
            && let Some((direction, density, weight)) = surface.sample(direction)
        {
            sum += self.sampled_light_along(receiver, direction, density) * weight;
        }
        sum.as_vec3()
    }

    /// Radiance of sampled lights from a direction that was chosen with `density`, weighted against light sampling.
    fn sampled_light_along(&self, receiver: &Receiver, direction: DVec3, density: f64) -> DVec3 {
        let Receiver { point, position, inside, .. } = receiver;
        let (light, light_density, distance) = match self.tracer.first_hit_from(*point, direction) {
            None => {
                let (radiance, light_density) = self.lights.environment_along(&self.world, direction);
                (radiance, light_density, f64::INFINITY)
            }
            Some(hit) => {
                let place = hit.point.position(self.scene());
                let light_density = self.lights.emitter_density(hit.point.triangle, place, *position);
                (emitted(self.scene(), hit.point, -direction), light_density, hit.t)
            }
        };
        if light_density == 0.0 {
            return DVec3::ZERO;
        }
        let share = power_heuristic(density, light_density);
        light.as_dvec3() * share * self.media.attenuation(inside, distance)
    }

    /// Irradiance/π of all other light, by one path; `lookup` says where it ends.
    pub(crate) fn arriving_indirect(
        &self,
        receiver: &Receiver,
        mut random: PathRandom,
        lookup: IrradianceLookup<'_>,
    ) -> IndirectRay {
        let Some((direction, density, weight)) = receiver.surface.sample(random.next2()) else {
            return IndirectRay { light: Vec3::ZERO, distance: f64::INFINITY, link: None };
        };
        let mut path = Path { random, inside: receiver.inside, lights: LightsPerDirection::uniform(1.0) };
        let step =
            Step { origin: receiver.point, position: receiver.position, direction, density: Some(density) };
        let path_light = self.trace_path(step, &mut path, lookup);
        IndirectRay {
            light: (weight * path_light.indirect).as_vec3(),
            distance: path_light.distance,
            link: path_light.cached_end.map(|(cached, share)| PatchRayLink {
                place: cached.place,
                irradiance: cached.irradiance,
                weight: (weight * share).as_vec3(),
                albedo: weight * path_light.albedo,
                choice: path.random.next(),
            }),
        }
    }
}
