//! Lookup of cached irradiance along paths.

use crate::irradiance::Irradiance;
use crate::irradiance::gathered::PatchGatherer;
use crate::irradiance::patches::Patches;
use crate::irradiance::place::Place;
use crate::irradiance::solved::SolvedPatches;
use glam::Vec3;
use scene::SurfacePoint;
use std::sync::Arc;

/// How cached irradiance is used.
pub(super) enum CacheMode {
    Disabled,
    /// It is taken for exact.
    Trusted(Arc<Irradiance>),
    /// It is a control variate: paths correct its error.
    ControlVariate(Arc<Irradiance>),
}

impl CacheMode {
    /// The cache, if it is trusted; otherwise `None`.
    pub fn trusted(&self) -> Option<&Irradiance> {
        if let Self::Trusted(irradiance) = self { Some(irradiance) } else { None }
    }

    /// The cache, if it is a control variate; otherwise `None`.
    pub fn control_variate(&self) -> Option<&Irradiance> {
        if let Self::ControlVariate(irradiance) = self { Some(irradiance) } else { None }
    }
}

/// What a path can look up of the scene's light.
#[derive(Clone, Copy)]
pub(crate) enum IrradianceLookup<'a> {
    Unavailable,
    /// Nothing yet, but the patches where irradiance will be solved.
    Unsolved(&'a Patches),
    /// What is solved, for smaller patches that gather it, and for lobes so wide that they see no more.
    Solved(&'a SolvedPatches),
    Trusted(&'a Irradiance),
    /// Indirect irradiance; direct light is sampled. Some paths go on to correct its error.
    ControlVariate(&'a Irradiance),
}

/// A place that a path came to, whose irradiance is cached or will be.
pub(crate) struct CachedPlace {
    pub place: Place,
    /// Irradiance/π there; 0 while it is still being solved.
    pub irradiance: Vec3,
}

/// How a path came to a place.
#[derive(Clone, Copy)]
pub(crate) struct Arrival {
    /// Length of its last segment, scene units.
    pub distance: f64,
    /// Number of surfaces that scattered it, with the one that it left first.
    pub scatterings: u32,
    /// The least density, 1/sr, with which its directions were sampled; `None` if none of them was spread.
    pub density: Option<f64>,
}

/// Hits nearer than this many patch sizes are not looked up: patches are too coarse for them.
const MIN_DISTANCE_PATCHES: f64 = 2.0;
/// After this many scattering events nobody sees the patches any more.
const MAX_NEAR_SCATTERINGS: u32 = 3;

impl IrradianceLookup<'_> {
    /// Whether some paths go on past cached irradiance.
    pub fn is_control_variate(self) -> bool {
        matches!(self, Self::ControlVariate(_))
    }

    /// Whether paths must not send on more than the albedos along them, for the price of a small bias: what is solved
    /// would grow from bounce to bounce. Unbiased paths have weights of mean 1 that are not bounded.
    pub fn is_bounded(self) -> bool {
        matches!(self, Self::Unsolved(_) | Self::Solved(_) | Self::Trusted(_))
    }

    /// Throughput below which Russian roulette ends paths. The rays of a patch are few, and their sum is bounded: there
    /// it would cut off what roulette adds to the surviving ones.
    pub fn roulette_throughput(self) -> f64 {
        if matches!(self, Self::Unsolved(_) | Self::Solved(_)) { 0.05 } else { 1.0 }
    }

    /// The cached place at a surface point, on its front or its back, that a path came to; `None` if nothing is cached there, or
    /// the path is so short that the patches would show.
    pub fn cached_place(
        self,
        gatherer: &impl PatchGatherer,
        (point, is_front): (SurfacePoint, bool),
        arrival: Arrival,
    ) -> Option<CachedPlace> {
        let Arrival { distance, scatterings, density } = arrival;
        let scene = gatherer.scene();
        let part = scene.triangles[point.triangle as usize].part;
        let lookup = match (self, density) {
            // Where bounces are limited, small patches have one more.
            (Self::Trusted(irradiance), Some(density))
                if gatherer.bounces().is_none() && irradiance.solved().resolve(part, distance, density) =>
            {
                Self::Solved(irradiance.solved())
            }
            _ => self,
        };
        let spacing = match lookup {
            Self::Unavailable => return None,
            Self::Unsolved(patches) => patches.spacing(part),
            Self::Solved(solved) => solved.patches.spacing(part),
            Self::Trusted(irradiance) | Self::ControlVariate(irradiance) => irradiance.spacing(part),
        };
        if distance < MIN_DISTANCE_PATCHES * spacing && scatterings <= MAX_NEAR_SCATTERINGS {
            return None;
        }
        let place = Place::new(scene, point, is_front);
        let irradiance = match lookup {
            Self::Unavailable => None,
            Self::Unsolved(patches) => patches.covers(&place).then_some(Vec3::ZERO),
            Self::Solved(solved) => solved.total(&place),
            Self::Trusted(irradiance) => irradiance.total(gatherer, &place),
            Self::ControlVariate(irradiance) => irradiance.indirect(gatherer, &place),
        };
        irradiance.map(|irradiance| CachedPlace { place, irradiance })
    }
}
