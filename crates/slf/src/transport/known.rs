//! What of a scene's light is known before paths are traced, and where they come to it.

use crate::irradiance::Irradiance;
use crate::irradiance::patches::Patches;
use crate::irradiance::place::Place;
use glam::Vec3;
use scene::{Scene, SurfacePoint};
use std::sync::Arc;

/// Light that is kept, and what is made of it.
pub(super) enum CacheMode {
    Disabled,
    /// It stands for what it tells.
    Trusted(Arc<Irradiance>),
    /// A control variate: paths say how far it is off.
    ControlVariate(Arc<Irradiance>),
}

impl CacheMode {
    /// What stands for itself.
    pub fn trusted(&self) -> Option<&Irradiance> {
        if let Self::Trusted(irradiance) = self { Some(irradiance) } else { None }
    }

    /// What does not.
    pub fn control_variate(&self) -> Option<&Irradiance> {
        if let Self::ControlVariate(irradiance) = self { Some(irradiance) } else { None }
    }
}

/// What of the scene's light a path knows.
#[derive(Clone, Copy)]
pub(super) enum IrradianceLookup<'a> {
    Unavailable,
    /// Where it will be.
    Unsolved(&'a Patches),
    Trusted(&'a Irradiance),
    /// The same but for what lamps send straight, which paths find: some of them go on, to find out how far it is off.
    ControlVariate(&'a Irradiance),
}

/// A place that a path came to, where what arrives at diffuse lobes is known or will be.
pub(super) struct CachedPlace {
    pub place: Place,
    /// Irradiance/π there; 0 where it is not solved for yet.
    pub irradiance: Vec3,
}

/// A surface that is nearer than so many patches is too near for them to tell.
const MIN_DISTANCE_PATCHES: f64 = 2.0;

impl IrradianceLookup<'_> {
    /// Whether some paths go on where it is known.
    pub fn is_control_variate(self) -> bool {
        matches!(self, Self::ControlVariate(_))
    }

    /// A place that a path came to over a distance, if what arrives there is known.
    pub fn cached_place(
        self,
        scene: &Scene,
        point: SurfacePoint,
        is_front: bool,
        distance: f64,
    ) -> Option<CachedPlace> {
        let spacing = match self {
            Self::Unavailable => return None,
            Self::Unsolved(patches) => patches.spacing(),
            Self::Trusted(irradiance) | Self::ControlVariate(irradiance) => irradiance.spacing(),
        };
        if distance < MIN_DISTANCE_PATCHES * spacing {
            return None;
        }
        let place = Place::new(scene, point, is_front);
        let irradiance = match self {
            Self::Unavailable => None,
            Self::Unsolved(patches) => patches.covers(&place).then_some(Vec3::ZERO),
            Self::Trusted(irradiance) => irradiance.total(&place),
            Self::ControlVariate(irradiance) => irradiance.indirect(&place),
        };
        irradiance.map(|irradiance| CachedPlace { place, irradiance })
    }
}
