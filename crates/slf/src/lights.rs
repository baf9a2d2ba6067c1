//! Light sampling: all light sources of a scene and its world.

use crate::emitters::Emitters;
use crate::environment_light::{EnvironmentLight, EnvironmentSample};
use crate::punctual::{PunctualLight, unshadowed_light};
use glam::{DVec3, Vec3};
use scene::{Scene, World};

/// The lights of a scene and its world.
#[derive(Debug)]
pub(crate) struct Lights {
    emitters: Emitters,
    environment: Option<EnvironmentLight>,
    /// Number of punctual lights.
    punctual: usize,
    /// A distance that leaves the scene from anywhere in it.
    outside_distance: f64,
}

/// Light that may arrive from one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightSample {
    /// Unit direction toward the light.
    pub direction: DVec3,
    /// World position of the light, or a point outside the scene; the light arrives unless the segment to it is
    /// occluded.
    pub source: DVec3,
    /// Whether `source` is the light itself; otherwise the light is infinitely far away.
    pub is_near: bool,
    /// Radiance over density, or a punctual light's irradiance over the probability of having chosen it.
    pub light: Vec3,
    /// Density of the direction, 1/sr; `None` for a punctual light, which no other sampling technique can hit.
    pub density: Option<f64>,
    /// Index into the scene's lights, if the light is punctual.
    pub punctual_index: Option<usize>,
}

impl LightSample {
    /// Whether it is a direction of the environment.
    pub fn is_sky(&self) -> bool {
        self.density.is_some() && !self.is_near
    }
}

/// How many light samples to take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DrawCounts {
    /// Total number of samples.
    pub total: u32,
    /// How many of them, from the first on, include punctual lights.
    pub punctual: u32,
}

/// Up to this many punctual lights are all visited; of more, one is sampled by the light it would send.
const MAX_PUNCTUAL_ENUMERATED: usize = 3;

impl Lights {
    /// The lights of a scene and its world, prepared for sampling.
    pub fn new(scene: &Scene, world: &World) -> Self {
        let (low, high) = scene.bounds();
        let outside_distance = 2.0 * (high - low).length();
        let (emitters, environment) = (Emitters::from_scene(scene), EnvironmentLight::from_world(world));
        Self { emitters, environment, punctual: scene.lights.len(), outside_distance }
    }

    /// The number of punctual lights in the scene.
    pub fn punctual_count(&self) -> usize {
        self.punctual
    }

    /// Whether there is any light source of finite extent: the environment or an emissive surface.
    pub fn has_areas(&self) -> bool {
        self.environment.is_some() || !self.emitters.is_empty()
    }

    /// Whether the environment is sampled.
    pub fn has_sky(&self) -> bool {
        self.environment.is_some()
    }

    /// Whether any surface emits light.
    pub fn has_emitters(&self) -> bool {
        !self.emitters.is_empty()
    }

    /// The number of samples for area lights and for punctual lights if `requested` samples are asked for. Sources that
    /// give the same result every time are sampled once.
    pub fn draw_counts(&self, requested: u32) -> DrawCounts {
        let punctual = if self.punctual <= MAX_PUNCTUAL_ENUMERATED { 1 } else { requested.min(4) };
        DrawCounts { total: if self.has_areas() { requested.max(punctual) } else { punctual }, punctual }
    }

    /// Samples one direction of the environment, one point on an emitter and, if `with_punctual`, the punctual lights.
    /// `draw` returns uniform numbers in [0, 1).
    pub fn sample(
        &self,
        scene: &Scene,
        position: DVec3,
        with_punctual: bool,
        mut draw: impl FnMut() -> f64,
        mut visit: impl FnMut(LightSample),
    ) {
        self.sample_areas(scene, position, &mut draw, &mut visit);
        if with_punctual {
            self.sample_punctual(scene, position, MAX_PUNCTUAL_ENUMERATED, draw, visit);
        }
    }

    /// Samples one direction of the environment and one point on an emitter, for light that arrives at `position`.
    /// `draw` makes uniform numbers in [0, 1); `visit` gets each sample that sends light.
    pub fn sample_areas(
        &self,
        scene: &Scene,
        position: DVec3,
        mut draw: impl FnMut() -> f64,
        mut visit: impl FnMut(LightSample),
    ) {
        if self.has_sky()
            && let Some(sky) = self.sample_sky([draw(), draw()])
        {
            visit(self.sky_at(&sky, position));
        }
        self.sample_emitters(scene, position, draw, visit);
    }

    /// Samples one direction of the environment from uniform numbers, as it is for light that arrives at the origin. `None`
    /// if the environment is not sampled.
    pub fn sample_sky(&self, u: [f64; 2]) -> Option<LightSample> {
        let EnvironmentSample { direction, radiance, density } = self.environment.as_ref()?.sample(u);
        Some(LightSample {
            direction,
            source: direction * self.outside_distance,
            is_near: false,
            light: radiance / density as f32,
            density: Some(density),
            punctual_index: None,
        })
    }

    /// A direction of the environment, for light that arrives at `position`.
    pub fn sky_at(&self, sky: &LightSample, position: DVec3) -> LightSample {
        LightSample { source: position + sky.direction * self.outside_distance, ..*sky }
    }

    /// Samples one point on an emitter, for light that arrives at `position`. `draw` makes uniform numbers in [0, 1).
    pub fn sample_emitters(
        &self,
        scene: &Scene,
        position: DVec3,
        mut draw: impl FnMut() -> f64,
        mut visit: impl FnMut(LightSample),
    ) {
        if self.emitters.is_empty() {
            return;
        }
        let (choice, place) = (draw(), [draw(), draw()]);
        if let Some(sample) = self.emitters.sample(scene, position, choice, place) {
            visit(LightSample {
                direction: sample.direction,
                source: sample.place,
                is_near: true,
                light: sample.radiance / sample.density as f32,
                density: Some(sample.density),
                punctual_index: None,
            });
        }
    }

    /// Visits all punctual lights if there are at most `max_enumerated`; otherwise samples one by the light it would
    /// send.
    pub fn sample_punctual(
        &self,
        scene: &Scene,
        position: DVec3,
        max_enumerated: usize,
        mut draw: impl FnMut() -> f64,
        mut visit: impl FnMut(LightSample),
    ) {
        let near = |light: &scene::Light| light.kind != scene::LightKind::Directional;
        let arrivals = || {
            let lights = scene.lights.iter().enumerate();
            lights.filter_map(|(index, light)| {
                Some((index, unshadowed_light(light, position, self.outside_distance)?, near(light)))
            })
        };
        let mut visit_light = |(index, arrival, is_near): (usize, PunctualLight, bool), share: f32| {
            let PunctualLight { direction, source, irradiance } = arrival;
            let (light, punctual_index) = (irradiance / share, Some(index));
            visit(LightSample { direction, source, is_near, light, density: None, punctual_index });
        };
        if scene.lights.len() <= max_enumerated {
            arrivals().for_each(|light| visit_light(light, 1.0));
            return;
        }
        let sum: f32 = arrivals().map(|(_, arrival, _)| arrival.irradiance.element_sum()).sum();
        let mut rest = draw() as f32 * sum;
        let chosen = arrivals().find(|(_, arrival, _)| {
            rest -= arrival.irradiance.element_sum();
            rest < 0.0
        });
        if let Some(light) = chosen.filter(|_| sum > 0.0) {
            let share = light.1.irradiance.element_sum() / sum;
            visit_light(light, share);
        }
    }

    /// The radiance (linear RGB) that arrives from a direction (unit, world) of `world`, and the density, 1/sr, with which
    /// [`Self::sample`] chooses it: 0 if the environment is not sampled.
    pub fn environment_along(&self, world: &World, direction: DVec3) -> (Vec3, f64) {
        match &self.environment {
            Some(environment) => {
                let EnvironmentSample { radiance, density, .. } = environment.along(direction);
                (radiance, density)
            }
            None => (world.radiance(direction), 0.0),
        }
    }

    /// Density, 1/sr, with which [`Self::sample`] chooses a point on a triangle from a position.
    pub fn emitter_density(&self, triangle: u32, place: DVec3, position: DVec3) -> f64 {
        self.emitters.density(triangle, place, position)
    }
}
