//! Irradiance cached on the surface, independent of the camera.
//!
//! The surface is divided into patches ([`patches`]): the surface of one part within one lattice cell that faces
//! roughly one direction. Each stores the light that arrives at it: *direct* (from sampled lights, with occlusion) and
//! *indirect* (everything else), solved bounce by bounce (`irradiance_solver`). Between patches irradiance is
//! interpolated by position and normal, so it is continuous except between parts; surfaces that face away, such as the
//! other side of a wall, do not contribute. A surface point sends its diffuse albedo times E/π of it. The cache also
//! holds the light of an unoccluded sky by normal (`open_sky`).

mod lattice;
mod patch_sizes;
pub(crate) mod patches;
pub(crate) mod place;

use crate::open_sky::OpenSky;
use glam::{DVec3, Vec3};
use patches::Patches;
use place::Place;
use scene::World;
use trace::IncidentLight;

/// Irradiance at every patch of a scene's surface.
///
/// Solved once for a scene and its world by [`Irradiance::solve`]; used by
/// [`Transport::with_irradiance`](crate::Transport::with_irradiance) and
/// [`Transport::with_control_variate`](crate::Transport::with_control_variate).
#[derive(Debug)]
pub struct Irradiance {
    patches: Patches,
    solution: IrradianceSolution,
    sky: Option<OpenSky>,
}

/// Solved irradiance: together with the scene, the world and the solver's options this is all that needs to be stored.
#[derive(Clone, Debug, PartialEq)]
pub struct IrradianceSolution {
    /// Irradiance/π by patch (linear RGB radiance units), from sampled lights.
    pub direct: Vec<Vec3>,
    /// Irradiance/π by patch, all other light.
    pub indirect: Vec<Vec3>,
    /// Whether light was cut off after [`MAX_BOUNCES`](crate::MAX_BOUNCES) before it had died away.
    pub is_cut_off: bool,
}

impl Irradiance {
    /// Wraps solved values of patches in a world.
    pub(crate) fn new(patches: Patches, solution: IrradianceSolution, world: &World) -> Self {
        Self { patches, solution, sky: OpenSky::from_world(world) }
    }

    /// What was solved; see [`Irradiance::from_solution`].
    pub fn solution(&self) -> &IrradianceSolution {
        &self.solution
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        self.patches.bytes() + size_of_val(&*self.solution.direct) + size_of_val(&*self.solution.indirect)
    }

    /// Irradiance/π that an unoccluded environment sends to a surface with this normal; `None` if the environment is
    /// not sampled as a light.
    pub(crate) fn unshaded(&self, world: &World, normal: DVec3) -> Option<DVec3> {
        self.sky.as_ref().map(|sky| sky.at(world, normal))
    }

    /// Irradiance/π that incident light gives to a surface with this shading normal.
    pub(crate) fn shaded(&self, world: &World, shaded: &IncidentLight, normal: DVec3) -> DVec3 {
        (self.unshaded(world, normal).unwrap_or_default() + shaded.irradiance_over_pi(normal).as_dvec3())
            .max(DVec3::ZERO)
    }

    /// Side of a lattice cell for the patches of a part, world units.
    pub(crate) fn spacing(&self, part: u32) -> f64 {
        self.patches.spacing(part)
    }

    /// Indirect irradiance/π at a place; `None` if no patch covers it.
    pub(crate) fn indirect(&self, place: &Place) -> Option<Vec3> {
        self.interpolate(place, |patch| self.solution.indirect[patch])
    }

    /// Direct and indirect irradiance/π at a place; `None` if no patch covers it.
    pub(crate) fn total(&self, place: &Place) -> Option<Vec3> {
        self.interpolate(place, |patch| self.solution.direct[patch] + self.solution.indirect[patch])
    }

    fn interpolate(&self, place: &Place, value: impl Fn(usize) -> Vec3) -> Option<Vec3> {
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for (patch, weight) in self.patches.around(place) {
            sum += value(patch as usize) * weight;
            weights += weight;
        }
        (weights > 0.0).then(|| sum / weights)
    }
}
