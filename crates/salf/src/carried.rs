//! The resolution of carried light.

use lens::FocusOffset;
use surface::SurfaceField;

/// How finely carried light is sampled over the aperture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Carried {
    /// As its picture through the ordinary lens needs it: the more coarsely the farther out of focus.
    #[default]
    Standard,
    /// As finely as any focus may show it.
    Painted,
}

impl Carried {
    /// How finely carried light must be sampled for a focus: finely if gloss lets carried light obey the paint.
    pub fn for_focus(focus: &dyn SurfaceField<FocusOffset>) -> Self {
        if focus.affects_carried_light() { Self::Painted } else { Self::Standard }
    }
}
