//! Light that changes alike everywhere.

use glam::Vec3;

/// How the light of a scene changes, if what is lit by what stays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightChange {
    /// The factor of all light, ≥ 0.
    pub factor: f32,
    /// The radiance (linear RGB, ≥ 0) wherever no surface is; `None` if it changes by the factor, too.
    pub backdrop: Option<Vec3>,
}

impl LightChange {
    /// Whether light of the background, or of surfaces, changes at all.
    pub(crate) fn changes(&self, is_background: bool) -> bool {
        self.factor != 1.0 || (is_background && self.backdrop.is_some())
    }

    /// What becomes of a radiance.
    pub(crate) fn changed(&self, radiance: Vec3, is_background: bool) -> Vec3 {
        self.backdrop.filter(|_| is_background).unwrap_or(radiance * self.factor)
    }
}
