//! What fills the aperture of a pixel.

use super::cells::{SLICES, add_share};

/// What covers a pixel.
pub(super) struct Covers {
    /// By slice of depth: its light, and how much of the aperture it covers.
    pub slices: [[f32; 5]; SLICES],
    /// The slices that are not empty, a bit each.
    pub occupied: u32,
    /// The smallest radius, px.
    pub min_radius: f32,
}

impl Covers {
    pub const NONE: Self = Self { slices: [[0.0; 5]; SLICES], occupied: 0, min_radius: f32::INFINITY };

    /// What fills the aperture: the nearest first, until it is full.
    pub fn nearest_first(&self) -> [f32; 5] {
        let (mut shown, mut left) = ([0.0f32; 5], self.occupied);
        while left != 0 && shown[4] < 1.0 {
            let slice = &self.slices[left.trailing_zeros() as usize];
            left &= left - 1;
            let share = ((1.0 - shown[4]) / slice[4]).min(1.0);
            add_share(&mut shown, slice, share);
        }
        shown
    }
}
