//! What of a scene's light is known before paths are traced, and where they come to it.

use crate::irradiance::Irradiance;
use crate::irradiance::patches::Patches;
use crate::irradiance::place::Place;
use glam::Vec3;
use scene::{Scene, SurfacePoint};
use std::sync::Arc;

/// Light that is kept, and what is made of it.
pub(super) enum Kept {
    Nothing,
    /// It stands for what it tells.
    Trusted(Arc<Irradiance>),
    /// A control variate: paths say how far it is off.
    Checked(Arc<Irradiance>),
}

impl Kept {
    /// What stands for itself.
    pub fn trusted(&self) -> Option<&Irradiance> {
        if let Self::Trusted(irradiance) = self { Some(irradiance) } else { None }
    }

    /// What does not.
    pub fn to_be_checked(&self) -> Option<&Irradiance> {
        if let Self::Checked(irradiance) = self { Some(irradiance) } else { None }
    }
}

/// What of the scene's light a path knows.
#[derive(Clone, Copy)]
pub(super) enum Known<'a> {
    Nothing,
    /// Where it will be.
    Patches(&'a Patches),
    All(&'a Irradiance),
    /// The same but for what lamps send straight, which paths find: some of them go on, to find out how far it is off.
    Checked(&'a Irradiance),
}

/// A place that a path came to, where what arrives at diffuse lobes is known or will be.
pub(super) struct Reached {
    pub place: Place,
    /// Irradiance/π there; 0 where it is not solved for yet.
    pub irradiance: Vec3,
}

/// A surface that is nearer than so many patches is too near for them to tell.
const NEAR: f64 = 2.0;

impl Known<'_> {
    /// Whether some paths go on where it is known.
    pub fn is_to_be_checked(self) -> bool {
        matches!(self, Self::Checked(_))
    }

    /// A place that a path came to over a distance, if what arrives there is known.
    pub fn reached(
        self,
        scene: &Scene,
        point: SurfacePoint,
        is_front: bool,
        distance: f64,
    ) -> Option<Reached> {
        let spacing = match self {
            Self::Nothing => return None,
            Self::Patches(patches) => patches.spacing(),
            Self::All(irradiance) | Self::Checked(irradiance) => irradiance.spacing(),
        };
        if distance < NEAR * spacing {
            return None;
        }
        let place = Place::of(scene, point, is_front);
        let irradiance = match self {
            Self::Nothing => None,
            Self::Patches(patches) => patches.knows(&place).then_some(Vec3::ZERO),
            Self::All(irradiance) => irradiance.total(&place),
            Self::Checked(irradiance) => irradiance.indirect(&place),
        };
        irradiance.map(|irradiance| Reached { place, irradiance })
    }
}
