//! The world beyond all surfaces: it lights them, and is the backdrop.

mod built_in;
mod cube_map;
mod environment_map;
mod sky;
mod studio;

pub use built_in::BuiltInEnvironment;
pub(crate) use cube_map::CubeMap;
pub use environment_map::EnvironmentMap;

use glam::{DVec3, Vec3};
use std::sync::Arc;

/// The world around a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    /// Light from infinity.
    pub environment: Environment,
    /// Rotation of the environment about +Y, counter-clockwise seen from above, rad.
    pub rotation: f64,
    /// Factor of its radiance, ≥ 0.
    pub strength: f32,
    /// What the camera sees where there is no surface. It lights nothing.
    pub backdrop: Backdrop,
    /// Maximum number of scattering events before the last one, toward the camera: 0 is direct light only; `None`: as
    /// many as matter, up to a fixed limit.
    pub bounces: Option<u32>,
}

/// Radiance from infinity.
#[derive(Clone, Debug)]
pub enum Environment {
    /// The same from all directions, linear RGB.
    Uniform(Vec3),
    /// An environment map.
    Map(Arc<EnvironmentMap>),
}

impl PartialEq for Environment {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Uniform(a), Self::Uniform(b)) => a == b,
            // Millions of texels are not compared with themselves.
            (Self::Map(a), Self::Map(b)) => Arc::ptr_eq(a, b) || a == b,
            _ => false,
        }
    }
}

impl Environment {
    /// The built-in environment that it is; `None` if it is another.
    pub fn built_in(&self) -> Option<BuiltInEnvironment> {
        let Self::Map(map) = self else { return None };
        BuiltInEnvironment::ALL.into_iter().find(|built_in| Arc::ptr_eq(&built_in.map(), map))
    }
}

/// What the camera sees at infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Backdrop {
    /// The environment.
    Environment,
    /// A colour, linear RGB.
    Color(Vec3),
}

/// The backdrop of a scene without light: the middle of a display's scale.
const NEUTRAL_GREY: f32 = 0.21;

impl World {
    /// A world of the same radiance (linear RGB) everywhere, as light and as backdrop.
    pub fn uniform(radiance: Vec3) -> Self {
        Self {
            environment: Environment::Uniform(radiance),
            rotation: 0.0,
            strength: 1.0,
            backdrop: Backdrop::Environment,
            bounces: None,
        }
    }

    /// A world with the light of a built-in environment. The studio has a neutral grey backdrop; the skies are seen.
    pub fn built_in(environment: BuiltInEnvironment) -> Self {
        let backdrop = match environment {
            BuiltInEnvironment::Studio => Backdrop::Color(Vec3::splat(NEUTRAL_GREY)),
            BuiltInEnvironment::Overcast | BuiltInEnvironment::Evening => Backdrop::Environment,
        };
        Self { environment: Environment::Map(environment.map()), backdrop, ..Self::uniform(Vec3::ZERO) }
    }

    /// A soft neutral studio for scenes without any light, with a neutral grey backdrop.
    pub fn studio() -> Self {
        Self::built_in(BuiltInEnvironment::Studio)
    }

    /// The world as light alone: worlds that differ in their backdrop have the same.
    pub fn lighting(&self) -> Self {
        Self { backdrop: Backdrop::Environment, ..self.clone() }
    }

    /// The radiance (linear RGB) that arrives from a direction (world, unit).
    pub fn radiance(&self, direction: DVec3) -> Vec3 {
        let radiance = match &self.environment {
            Environment::Uniform(radiance) => *radiance,
            Environment::Map(map) => map.radiance(self.environment_from_world(direction)),
        };
        radiance * self.strength
    }

    /// The radiance (linear RGB) that the camera sees in a direction (world, unit) without a surface.
    pub fn backdrop_radiance(&self, direction: DVec3) -> Vec3 {
        match self.backdrop {
            Backdrop::Environment => self.radiance(direction),
            Backdrop::Color(color) => color,
        }
    }

    /// A world direction in the environment's own axes, which are turned.
    pub fn environment_from_world(&self, direction: DVec3) -> DVec3 {
        glam::DQuat::from_rotation_y(-self.rotation) * direction
    }

    /// A direction of the environment's own axes in the world.
    pub fn world_from_environment(&self, direction: DVec3) -> DVec3 {
        glam::DQuat::from_rotation_y(self.rotation) * direction
    }
}
