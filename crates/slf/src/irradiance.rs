//! Irradiance cached on the surface, independent of the camera.
//!
//! The surface is divided into patches ([`patches`]): the surface of one part within one lattice cell that faces
//! roughly one direction. Each stores the light that arrives at it: *direct* (from sampled lights, with occlusion) and
//! *indirect* (everything else). Large patches are [solved](solved) together, bounce by bounce (`irradiance_solver`); small
//! ones [gather](gathered) what these send, once somebody looks there: light is computed where it is seen. Between patches
//! irradiance is interpolated by position and normal, so it is continuous except between parts; surfaces that face away,
//! such as the other side of a wall, do not contribute. A surface point sends its diffuse albedo times E/π of it. The
//! cache also holds the light of an unoccluded sky by normal (`open_sky`).

pub(crate) mod gathered;
mod lattice;
mod patch_sizes;
pub(crate) mod patches;
pub(crate) mod place;
pub(crate) mod smoothing;
pub(crate) mod solved;

use crate::open_sky::OpenSky;
use gathered::{GatheredIrradiance, GatheredPatches, PatchGatherer};
use glam::{DVec3, Vec3};
use patches::Patches;
use place::Place;
use scene::{Scene, World};
use solved::{IrradianceSolution, SolvedPatches};
use trace::IncidentLight;

/// Irradiance at every patch of a scene's surface.
///
/// Solved once for a scene and its world by [`Irradiance::solve`]; used by
/// [`Transport::with_irradiance`](crate::Transport::with_irradiance) and
/// [`Transport::with_control_variate`](crate::Transport::with_control_variate).
#[derive(Debug)]
pub struct Irradiance {
    solved: SolvedPatches,
    /// Smaller patches, if those that are solved are larger than asked for.
    gathered: Option<GatheredPatches>,
    sky: Option<OpenSky>,
}

/// Resolution of the irradiance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IrradianceOptions {
    /// Approximate number of patches.
    pub patches: u32,
    /// Rays per patch.
    pub rays: u32,
}

impl Default for IrradianceOptions {
    fn default() -> Self {
        Self { patches: 24_000, rays: 96 }
    }
}

/// Patches to one that is solved: what light a patch receives changes less than what it shows.
const PATCHES_PER_SOLVED: u32 = 12;

/// The least number of patches that are solved, if there are as many.
const MIN_SOLVED: u32 = 1500;

impl IrradianceOptions {
    /// Approximate number of patches that are solved.
    pub(crate) fn solved(self) -> u32 {
        (self.patches / PATCHES_PER_SOLVED).max(self.patches.min(MIN_SOLVED))
    }
}

impl Irradiance {
    /// Wraps solved patches of a scene in a world.
    pub(crate) fn new(
        solved: SolvedPatches,
        options: IrradianceOptions,
        scene: &Scene,
        world: &World,
    ) -> Self {
        let is_coarser = options.solved() < options.patches;
        let gathered = is_coarser
            .then(|| GatheredPatches::new(Patches::new(scene, options.patches), options.rays.max(1)));
        Self { solved, gathered, sky: OpenSky::from_world(world) }
    }

    /// Restores an irradiance from its [`solution`](Irradiance::solution), of the same scene, world and options; `None`
    /// if the number of values does not match or one is not finite.
    pub fn from_solution(
        scene: &Scene,
        world: &World,
        options: IrradianceOptions,
        solution: IrradianceSolution,
    ) -> Option<Self> {
        let patches = Patches::new(scene, options.solved());
        let fits = |values: &Vec<Vec3>| {
            values.len() == patches.all().len() && values.iter().all(|value| value.is_finite())
        };
        let is_valid = [&solution.direct, &solution.indirect].into_iter().all(fits);
        is_valid.then(|| Self::new(SolvedPatches { patches, solution }, options, scene, world))
    }

    /// What was solved; see [`Irradiance::from_solution`].
    pub fn solution(&self) -> &IrradianceSolution {
        &self.solved.solution
    }

    /// The patches that were solved.
    pub(crate) fn solved(&self) -> &SolvedPatches {
        &self.solved
    }

    /// What was gathered so far, for the places at which somebody looked.
    pub fn gathered(&self) -> GatheredIrradiance {
        self.gathered.as_ref().map(GatheredPatches::all_gathered).unwrap_or_default()
    }

    /// Takes over what an irradiance of the same scene, world and options [`gathered`](Irradiance::gathered); `false` if a patch
    /// does not exist or has a value that is not finite.
    pub fn restore(&self, gathered: &GatheredIrradiance) -> bool {
        match &self.gathered {
            Some(patches) => patches.restore(gathered),
            None => *gathered == GatheredIrradiance::default(),
        }
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        self.solved.bytes() + self.gathered.as_ref().map_or(0, GatheredPatches::bytes)
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
        self.gathered.as_ref().map_or(&self.solved.patches, |gathered| &gathered.patches).spacing(part)
    }

    /// Indirect irradiance/π at a place, with the help of `gatherer`; `None` if no patch covers it.
    pub(crate) fn indirect(&self, gatherer: &impl PatchGatherer, place: &Place) -> Option<Vec3> {
        match &self.gathered {
            Some(gathered) => gathered.indirect(gatherer, &self.solved, place),
            None => self.solved.indirect(place),
        }
    }

    /// Direct and indirect irradiance/π at a place, with the help of `gatherer`; `None` if no patch covers it.
    pub(crate) fn total(&self, gatherer: &impl PatchGatherer, place: &Place) -> Option<Vec3> {
        match &self.gathered {
            Some(gathered) => gathered.total(gatherer, &self.solved, place),
            None => self.solved.total(place),
        }
    }
}
