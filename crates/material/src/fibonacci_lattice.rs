//! Evenly spread points of the unit square, to integrate tables with.

use glam::DVec2;

/// The number of points of [`lattice`].
pub const LATTICE: usize = 610;

/// Fibonacci's lattice of 610 points: the most even lattice of that size for functions that are periodic along x (Niederreiter and
/// Sloan 1994).
pub fn lattice() -> impl Iterator<Item = DVec2> {
    const STEP: usize = 377;
    (0..LATTICE).map(|k| DVec2::new((k * STEP % LATTICE) as f64, k as f64 + 0.5) / LATTICE as f64)
}
