//! What the lens's character makes of a summed picture: where it is darker.

use super::character_optics::CharacterOptics;
use super::falloff::Falloff;
use glam::DVec2;

/// How a picture darkens toward its corners, beside what its rays lose at the rims themselves.
#[derive(Clone, Debug, PartialEq)]
pub struct Vignetting {
    optics: CharacterOptics,
    falloff: Option<Falloff>,
}

/// The factors of one place of the picture, in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vignette {
    /// cos⁴ of the angle to the axis, or 1: what radiance is multiplied by.
    pub angle: f32,
    /// F, or 1: coverage is divided by it, so that radiance over coverage is darker by F.
    pub rims: f32,
}

impl Vignetting {
    /// `None` if the picture does not darken.
    pub(crate) fn new(optics: CharacterOptics, falloff: Option<Falloff>) -> Option<Self> {
        (falloff.is_some() || optics.has_angle_falloff()).then_some(Self { optics, falloff })
    }

    /// The factors at `q`, half-heights from the axis.
    pub fn at(&self, q: DVec2) -> Vignette {
        Vignette {
            angle: self.optics.angle_falloff(q) as f32,
            rims: self.falloff.as_ref().map_or(1.0, |falloff| falloff.at(q)),
        }
    }
}

impl Vignette {
    /// A coverage over F; 0 where nothing arrives.
    #[inline]
    pub fn coverage(self, coverage: f32) -> f32 {
        if self.rims > 0.0 { coverage / self.rims } else { 0.0 }
    }
}
