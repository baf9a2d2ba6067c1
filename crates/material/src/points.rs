//! Evenly spread points of the unit square, to integrate tables with.

use glam::DVec2;

/// The first `count` points of Roberts' sequence (2018): 1/g and 1/g² of the golden ratio's generalisation g³ = g + 1.
pub fn spread(count: usize) -> impl Iterator<Item = DVec2> {
    const STEPS: DVec2 = DVec2::new(0.754_877_666_246_692_8, 0.569_840_290_998_053_3);
    (0..count).map(|k| {
        let at = DVec2::splat(0.5) + STEPS * k as f64;
        at - at.floor()
    })
}
