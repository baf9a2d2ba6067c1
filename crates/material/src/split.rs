//! Scattered light in two parts: the one that obeys the paint, and the one that does not.

use glam::DVec3;
use std::ops::{Add, AddAssign, Mul};

/// Scattered light in two parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Split {
    /// Scattered diffusely, and the share of rough gloss that is about as wide: it obeys the paint.
    pub own: DVec3,
    /// Mirrored and transmitted: it keeps the focus of the ordinary lens.
    pub carried: DVec3,
}

/// From this α on gloss is all own.
const ROUGH: f64 = 0.25;

/// Whether any light that a lobe of this α reflects is carried.
pub(crate) fn is_carried(alpha: f64) -> bool {
    alpha < ROUGH
}

impl Split {
    /// The sum of own and carried light.
    pub fn total(self) -> DVec3 {
        self.own + self.carried
    }

    /// Diffuse light.
    pub(crate) fn own(own: DVec3) -> Self {
        Self { own, carried: DVec3::ZERO }
    }

    /// Transmitted light.
    pub(crate) fn carried(carried: DVec3) -> Self {
        Self { own: DVec3::ZERO, carried }
    }

    /// Reflected light of a lobe of this α: its own share rises smoothly (3x² − 2x³) from 0 for a mirror to 1.
    pub(crate) fn mirrored(light: DVec3, alpha: f64) -> Self {
        let x = (alpha / ROUGH).min(1.0);
        let own = x * x * (3.0 - 2.0 * x);
        Self { own: light * own, carried: light * (1.0 - own) }
    }
}

impl Add for Split {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { own: self.own + other.own, carried: self.carried + other.carried }
    }
}

impl AddAssign for Split {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul<f64> for Split {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { own: self.own * factor, carried: self.carried * factor }
    }
}
