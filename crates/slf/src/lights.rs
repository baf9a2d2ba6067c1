//! All that shines, as a surface point finds it: by drawing a light for it.

use crate::emitters::Emitters;
use crate::environment_light::EnvironmentLight;
use crate::punctual::{Arrival, arrival};
use glam::{DVec3, Vec3};
use scene::{Scene, World};

/// The lights of a scene and its world.
#[derive(Debug)]
pub(crate) struct Lights {
    emitters: Emitters,
    environment: Option<EnvironmentLight>,
    /// How many punctual lights there are.
    punctual: usize,
    /// Longer than the scene is wide.
    beyond: f64,
}

/// Light that may arrive from one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightSample {
    /// Unit, toward the light.
    pub from: DVec3,
    /// The world position between which and the point nothing may stand.
    pub source: DVec3,
    /// Whether that is the light itself; else it lies beyond the scene.
    pub is_near: bool,
    /// Radiance over density, or a punctual light's irradiance over the probability to have chosen it.
    pub light: Vec3,
    /// Of the direction, 1/sr; none of a punctual light, which no other way of sampling finds.
    pub density: Option<f64>,
    /// Which of the scene's lights it is, if it is punctual.
    pub number: Option<usize>,
}

impl LightSample {
    /// Whether it is a direction of the environment.
    pub fn is_of_sky(&self) -> bool {
        self.density.is_some() && !self.is_near
    }
}

/// How often lights are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Draws {
    /// Draws in all.
    pub all: u32,
    /// The first of them, in which punctual lights are among them.
    pub punctual: u32,
}

/// So many punctual lights are all asked; of more one is drawn by what it would send.
const FEW: usize = 3;

impl Lights {
    pub fn of(scene: &Scene, world: &World) -> Self {
        let (low, high) = scene.bounds();
        let beyond = 2.0 * (high - low).length();
        let (emitters, environment) = (Emitters::of(scene), EnvironmentLight::of(world));
        Self { emitters, environment, punctual: scene.lights.len(), beyond }
    }

    /// How many punctual lights there are.
    pub fn punctual_count(&self) -> usize {
        self.punctual
    }

    /// Whether anything shines that has an extent: the sky, a lamp.
    pub fn has_areas(&self) -> bool {
        self.environment.is_some() || !self.emitters.is_empty()
    }

    /// Whether any surface is a light.
    pub fn has_emitters(&self) -> bool {
        !self.emitters.is_empty()
    }

    /// How often lamps and sky are to be drawn, and how often punctual lights, where so often would do: what is the same every time
    /// is asked once.
    pub fn draws(&self, wanted: u32) -> Draws {
        let punctual = if self.punctual <= FEW { 1 } else { wanted.min(4) };
        Draws { all: if self.has_areas() { wanted.max(punctual) } else { punctual }, punctual }
    }

    /// Draws lights for a position, each kind once, punctual ones if they are wanted; `draw` gives uniform numbers.
    pub fn sample(
        &self,
        scene: &Scene,
        world: &World,
        position: DVec3,
        with_punctual: bool,
        mut draw: impl FnMut() -> f64,
        mut visit: impl FnMut(LightSample),
    ) {
        self.sample_areas(scene, world, position, &mut draw, &mut visit);
        if with_punctual {
            self.sample_punctual(scene, position, FEW, draw, visit);
        }
    }

    /// Draws a direction of the sky and a place on a lamp.
    pub fn sample_areas(
        &self,
        scene: &Scene,
        world: &World,
        position: DVec3,
        mut draw: impl FnMut() -> f64,
        mut visit: impl FnMut(LightSample),
    ) {
        if let Some(environment) = &self.environment {
            let (direction, density) = environment.sample([draw(), draw()]);
            let from = world.turned(direction);
            let light = world.radiance(from) / density as f32;
            let source = position + from * self.beyond;
            let density = Some(density);
            visit(LightSample { from, source, is_near: false, light, density, number: None });
        }
        if !self.emitters.is_empty() {
            let (choice, place) = (draw(), [draw(), draw()]);
            if let Some(sample) = self.emitters.sample(scene, position, choice, place) {
                visit(LightSample {
                    from: sample.from,
                    source: sample.place,
                    is_near: true,
                    light: sample.radiance / sample.density as f32,
                    density: Some(sample.density),
                    number: None,
                });
            }
        }
    }

    /// Visits the punctual lights, all if they are `few` or less; else one is drawn by what it would send.
    pub fn sample_punctual(
        &self,
        scene: &Scene,
        position: DVec3,
        few: usize,
        mut draw: impl FnMut() -> f64,
        mut visit: impl FnMut(LightSample),
    ) {
        let near = |light: &scene::Light| light.kind != scene::LightKind::Directional;
        let arrivals = || {
            let lights = scene.lights.iter().enumerate();
            lights.filter_map(|(number, light)| {
                Some((number, arrival(light, position, self.beyond)?, near(light)))
            })
        };
        let mut punctual = |(number, arrival, is_near): (usize, Arrival, bool), share: f32| {
            let Arrival { from, source, irradiance } = arrival;
            let (light, number) = (irradiance / share, Some(number));
            visit(LightSample { from, source, is_near, light, density: None, number });
        };
        if scene.lights.len() <= few {
            arrivals().for_each(|light| punctual(light, 1.0));
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
            punctual(light, share);
        }
    }

    /// The density, 1/sr, with which [`Self::sample`] draws a direction (unit) from the environment.
    pub fn density_of_environment(&self, world: &World, direction: DVec3) -> f64 {
        self.environment.as_ref().map_or(0.0, |environment| environment.density(world.unturned(direction)))
    }

    /// The same of a place on a triangle.
    pub fn density_of_emitter(&self, triangle: u32, place: DVec3, position: DVec3) -> f64 {
        self.emitters.density(triangle, place, position)
    }
}
