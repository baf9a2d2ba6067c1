//! Light that is gathered for a point, and what of it chance found.

use glam::DVec3;
use material::{Scattered, Split};
use std::ops::{AddAssign, Mul};

/// Light that a point sends on.
#[derive(Clone, Copy, Default)]
pub(super) struct ScatteredLight {
    pub light: Split,
    /// What of it single paths found where few do.
    pub noisy: Split,
}

impl ScatteredLight {
    /// What is sent on of light that one direction found: directly, or by further surfaces. A mirror has no other direction to
    /// look in.
    pub fn from_direction(scattered: &Scattered, direct: DVec3, indirect: DVec3) -> Self {
        let light = scale_split(scattered.weight, direct + indirect);
        let is_random = scattered.density.is_some();
        let noisy = if is_random { scale_split(scattered.weight, indirect) } else { Split::default() };
        Self { light, noisy }
    }

    /// What of it is carried.
    pub fn carried(self) -> Self {
        let carried = |light: Split| Split { own: DVec3::ZERO, ..light };
        Self { light: carried(self.light), noisy: carried(self.noisy) }
    }

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

/// What is left of a split light.
pub(super) fn scale_split(light: Split, share: DVec3) -> Split {
    Split { own: light.own * share, carried: light.carried * share }
}

/// The larger of either, channel by channel.
pub(super) fn max_split(a: Split, b: Split) -> Split {
    Split { own: a.own.max(b.own), carried: a.carried.max(b.carried) }
}
