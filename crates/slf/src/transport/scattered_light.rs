//! Light that a point scatters, and the noisy part of it.

use glam::DVec3;
use material::{Scattered, Split};
use std::ops::{AddAssign, Mul};

/// Light that a point scatters toward the eye.
#[derive(Clone, Copy, Default)]
pub(super) struct ScatteredLight {
    pub light: Split,
    /// The part found by single random paths.
    pub noisy: Split,
}

impl ScatteredLight {
    /// Light scattered from one sampled direction: direct light, and light from further surfaces. A mirror's direction
    /// is not random, so it adds no noise.
    pub fn from_direction(scattered: &Scattered, direct: DVec3, indirect: DVec3) -> Self {
        let light = scale_split(scattered.weight, direct + indirect);
        let is_random = scattered.density.is_some();
        let noisy = if is_random { scale_split(scattered.weight, indirect) } else { Split::default() };
        Self { light, noisy }
    }

    /// The carried part alone: own light is black.
    pub fn carried(self) -> Self {
        let carried = |light: Split| Split { own: DVec3::ZERO, ..light };
        Self { light: carried(self.light), noisy: carried(self.noisy) }
    }

    /// The light times `share`, per colour.
    pub fn scaled(self, share: DVec3) -> Self {
        Self { light: scale_split(self.light, share), noisy: scale_split(self.noisy, share) }
    }
}

impl AddAssign for ScatteredLight {
    fn add_assign(&mut self, other: Self) {
        self.light += other.light;
        self.noisy += other.noisy;
    }
}

impl Mul<f64> for ScatteredLight {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { light: self.light * factor, noisy: self.noisy * factor }
    }
}

/// Multiplies both parts of a split light.
pub(super) fn scale_split(light: Split, share: DVec3) -> Split {
    Split { own: light.own * share, carried: light.carried * share }
}

/// Maximum of both parts, channel by channel.
pub(super) fn max_split(a: Split, b: Split) -> Split {
    Split { own: a.own.max(b.own), carried: a.carried.max(b.carried) }
}
