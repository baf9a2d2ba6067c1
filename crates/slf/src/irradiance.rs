//! Irradiance kept on the surface: what has been scattered before, for every camera.
//!
//! The surface is parted into patches ([`patches`]): what lies in one cell of a lattice, of one part, and faces about one way. Each
//! knows the light that arrives at it: *direct* (of lights that are drawn, as far as nothing stands between) and *indirect* (all else),
//! solved for bounce by bounce (`solving`). Between patches it is interpolated by place and normal, so that it has no borders but
//! those of parts, and what faces away, a wall's other side above all, has no say. What a surface sends of it is its diffuse lobes'
//! times E/π. Beside them it knows what the sky sends where nothing shades (`open_sky`).

mod lattice;
pub(crate) mod patches;
pub(crate) mod place;

use crate::open_sky::OpenSky;
use glam::{DVec3, Vec3};
use patches::Patches;
use place::Place;
use scene::World;
use trace::IncidentLight;

/// Light that arrives at every patch of a scene's surface.
#[derive(Debug)]
pub struct Irradiance {
    patches: Patches,
    /// Irradiance/π by patch: of lights that are drawn.
    direct: Vec<Vec3>,
    /// And all other.
    indirect: Vec<Vec3>,
    sky: Option<OpenSky>,
}

impl Irradiance {
    /// Of what was solved for: irradiance/π by patch, in a world.
    pub(crate) fn new(patches: Patches, [direct, indirect]: [Vec<Vec3>; 2], world: &World) -> Self {
        Self { patches, direct, indirect, sky: OpenSky::from_world(world) }
    }

    /// Irradiance/π by patch: direct and indirect. With scene, world and the options it was solved with, all there is to keep.
    pub fn values(&self) -> [&[Vec3]; 2] {
        [&self.direct, &self.indirect]
    }

    /// Irradiance/π that the environment would send, did nothing shade the surface of this normal; none where it is not drawn.
    pub(crate) fn unshaded(&self, world: &World, normal: DVec3) -> Option<DVec3> {
        self.sky.as_ref().map(|sky| sky.at(world, normal))
    }

    /// Irradiance/π that a spot receives whose shaded normal is this.
    pub(crate) fn shaded(&self, world: &World, shaded: &IncidentLight, normal: DVec3) -> DVec3 {
        (self.unshaded(world, normal).unwrap_or_default() + shaded.irradiance_over_pi(normal).as_dvec3())
            .max(DVec3::ZERO)
    }

    /// The side of a patch, world units.
    pub(crate) fn spacing(&self) -> f64 {
        self.patches.spacing()
    }

    /// Indirect irradiance/π at a place; `None` where no patch is.
    pub(crate) fn indirect(&self, place: &Place) -> Option<Vec3> {
        self.interpolate(place, |patch| self.indirect[patch])
    }

    /// All irradiance/π at a place; `None` where no patch is.
    pub(crate) fn total(&self, place: &Place) -> Option<Vec3> {
        self.interpolate(place, |patch| self.direct[patch] + self.indirect[patch])
    }

    fn interpolate(&self, place: &Place, value: impl Fn(usize) -> Vec3) -> Option<Vec3> {
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        self.patches.visit_around(place, |patch, weight| {
            sum += value(patch as usize) * weight;
            weights += weight;
        });
        (weights > 0.0).then(|| sum / weights)
    }
}
