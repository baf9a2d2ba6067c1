//! Circles of confusion by their size: those of a level are a few of its cells wide.

/// The circle of a hit in focus has at least this radius, px: its own pixel, and a little of those beside it, as edges are antialiased.
pub const MIN_RADIUS_PX: f32 = 0.67;
/// Radii of a level are at most so many of its cells.
pub const MAX_RADIUS_CELLS: f32 = 6.0;
/// Levels of cells of 1, 2, 4 … pixels.
pub const LEVELS: usize = 5;
/// Slices of depth, evenly spaced in 1/z.
pub const SLICES: usize = 32;
/// A surface hides another if it is nearer by this share of the depth.
pub const NEARER_SHARE: f32 = 0.01;
/// Radiance, and coverage of the picture.
pub type Value = [f32; 4];

/// Adds a share of something to a sum.
pub fn add_share(sum: &mut [f32; 5], added: &[f32; 5], share: f32) {
    for c in 0..5 {
        sum[c] += share * added[c];
    }
}

/// The level of a circle of this radius.
pub fn level_of(radius: f32) -> usize {
    (0..LEVELS - 1).find(|&level| radius <= MAX_RADIUS_CELLS * (1 << level) as f32).unwrap_or(LEVELS - 1)
}

/// The cells of a row or column whose middles are nearer than `reach` to a place.
pub fn cells_within(place: f32, reach: f32, count: usize) -> std::ops::Range<usize> {
    (place - reach).max(0.0) as usize..((place + reach) as usize + 1).min(count)
}
