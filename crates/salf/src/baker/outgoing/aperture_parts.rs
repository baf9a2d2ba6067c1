//! Light that varies over the aperture, merged into as few parts of it as possible.

use glam::Vec3;

/// The largest number of cells per side on which light is sampled.
pub const MAX_CELLS: usize = 8;

/// A part of the aperture, and what is sent toward it in the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AperturePart {
    /// The mean radiance toward the part, linear RGB.
    pub light: Vec3,
    /// The noisy part of it.
    pub noisy: Vec3,
    /// The part, on 8 × 8 cells.
    pub cells: u64,
}

/// Light toward each of `side` × `side` cells, row by row from v = −1, and the noisy part of it.
pub struct ApertureCells<'a> {
    /// The number of cells a side.
    pub side: usize,
    /// The radiance toward each cell, linear RGB.
    pub light: &'a [Vec3],
    /// The noisy part of the radiance toward each cell.
    pub noisy: &'a [Vec3],
}

impl ApertureCells<'_> {
    /// The cells of a square joined where none differs by more than `differs` from their mean, else those of its quarters.
    pub fn parts(&self, differs: f32) -> Vec<AperturePart> {
        let mut parts = Vec::new();
        self.join([0, 0], self.side, differs, &mut parts);
        parts
    }

    fn join(&self, [row, column]: [usize; 2], side: usize, differs: f32, parts: &mut Vec<AperturePart>) {
        let cells = || (0..side * side).map(|k| (row + k / side) * self.side + column + k % side);
        let mean = |of: &[Vec3]| cells().map(|cell| of[cell]).sum::<Vec3>() / (side * side) as f32;
        let light = mean(self.light);
        if cells().all(|cell| (self.light[cell] - light).abs().max_element() <= differs) {
            let finer = MAX_CELLS / self.side;
            let bits = u64::MAX >> (64 - side * finer) << (column * finer);
            let rows = row * finer..(row + side) * finer;
            let cells = rows.fold(0, |cells, row| cells | bits << (8 * row));
            parts.push(AperturePart { light, noisy: mean(self.noisy), cells });
            return;
        }
        for quarter in 0..4 {
            let half = side / 2;
            self.join([row + quarter / 2 * half, column + quarter % 2 * half], half, differs, parts);
        }
    }
}
