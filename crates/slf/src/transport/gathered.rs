//! Light that is gathered for a point, and what of it chance found.

use glam::DVec3;
use material::{Scattered, Split};
use std::ops::{AddAssign, Mul};

/// Light that a point sends on.
#[derive(Clone, Copy, Default)]
pub(super) struct Gathered {
    pub light: Split,
    /// What of it single paths found where few do.
    pub by_chance: Split,
}

impl Gathered {
    /// What is sent on of light that one direction found: directly, or by further surfaces. A mirror has no other direction to
    /// look in.
    pub fn by(scattered: &Scattered, direct: DVec3, by_others: DVec3) -> Self {
        let light = split(scattered.weight, direct + by_others);
        let is_chance = scattered.density.is_some();
        let by_chance = if is_chance { split(scattered.weight, by_others) } else { Split::default() };
        Self { light, by_chance }
    }

    /// What of it is carried.
    pub fn carried(self) -> Self {
        let carried = |light: Split| Split { own: DVec3::ZERO, ..light };
        Self { light: carried(self.light), by_chance: carried(self.by_chance) }
    }

    pub fn split(self, share: DVec3) -> Self {
        Self { light: split(self.light, share), by_chance: split(self.by_chance, share) }
    }
}

impl AddAssign for Gathered {
    fn add_assign(&mut self, other: Self) {
        self.light += other.light;
        self.by_chance += other.by_chance;
    }
}

impl Mul<f64> for Gathered {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { light: self.light * factor, by_chance: self.by_chance * factor }
    }
}

/// What is left of a split light.
pub(super) fn split(light: Split, share: DVec3) -> Split {
    Split { own: light.own * share, carried: light.carried * share }
}

/// The larger of either, channel by channel.
pub(super) fn most(a: Split, b: Split) -> Split {
    Split { own: a.own.max(b.own), carried: a.carried.max(b.carried) }
}
