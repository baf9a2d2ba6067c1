//! A grid over all directions.

use glam::{Vec2, Vec3};

/// An equirectangular grid of directions: rows from +y down to −y, columns from −x eastward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DirectionGrid {
    pub columns: usize,
    pub rows: usize,
}

impl DirectionGrid {
    /// A grid of directions with this many rows and twice as many columns.
    pub fn with_rows(rows: usize) -> Self {
        Self { columns: 2 * rows, rows }
    }

    /// The number of its cells.
    pub fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// Unit direction (world) of the centre of the cell with this number; rows run from +y to −y.
    pub fn direction(&self, cell: usize) -> Vec3 {
        let (x, y) = (cell % self.columns, cell / self.columns);
        let azimuth = ((x as f32 + 0.5) / self.columns as f32 - 0.5) * std::f32::consts::TAU;
        let polar = (y as f32 + 0.5) / self.rows as f32 * std::f32::consts::PI;
        let (sin, cos) = polar.sin_cos();
        Vec3::new(sin * azimuth.cos(), cos, sin * azimuth.sin())
    }

    /// The four cells around a unit direction with their bilinear weights, which sum to 1.
    pub fn around(&self, direction: Vec3) -> [(usize, f32); 4] {
        let azimuth = direction.z.atan2(direction.x) / std::f32::consts::TAU + 0.5;
        let polar = direction.y.clamp(-1.0, 1.0).acos() / std::f32::consts::PI;
        let at = Vec2::new(azimuth * self.columns as f32, polar * self.rows as f32) - 0.5;
        let floor = at.floor();
        let share = at - floor;
        let (columns, rows) = (self.columns as i64, self.rows as i64);
        let (x, y) = (floor.x as i64, floor.y as i64);
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| {
            let across = if dx == 0 { 1.0 - share.x } else { share.x };
            let down = if dy == 0 { 1.0 - share.y } else { share.y };
            // Beyond a pole, interpolation continues on the opposite meridian.
            let row = (y + dy).clamp(0, rows - 1);
            let column = (x + dx + if row == y + dy { 0 } else { columns / 2 }).rem_euclid(columns);
            ((row * columns + column) as usize, across * down)
        })
    }

    /// Means from weighted sums and weights, with a prior of weight `prior_weight` from the surrounding cells; black if
    /// there is no evidence at all.
    ///
    /// Push–pull (Gortler et al. 1996): each coarser grid pools two by two cells, down to a single row.
    pub fn smoothed(&self, sums: &[(Vec3, f32)], prior_weight: f32) -> Vec<Vec3> {
        if self.rows == 1 || self.rows % 2 == 1 {
            let (sum, weight) =
                sums.iter().fold((Vec3::ZERO, 0.0), |(s, w), (sum, weight)| (s + *sum, w + weight));
            let mean = if weight > 0.0 { sum / weight } else { Vec3::ZERO };
            return sums
                .iter()
                .map(|(sum, weight)| (*sum + mean * prior_weight) / (weight + prior_weight))
                .collect();
        }
        let coarser = Self::with_rows(self.rows / 2);
        let pooled = |cell: usize| {
            let (x, y) = (2 * (cell % coarser.columns), 2 * (cell / coarser.columns));
            let cells = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[dx, dy]| (y + dy) * self.columns + x + dx);
            cells.iter().fold((Vec3::ZERO, 0.0), |(sum, weight), &cell| {
                // A cell represents its solid angle however often it was observed.
                let evidence = sums[cell].1;
                let share = if evidence > prior_weight { prior_weight / evidence } else { 1.0 };
                (sum + sums[cell].0 * share, weight + evidence * share)
            })
        };
        let coarse = coarser.smoothed(&(0..coarser.count()).map(pooled).collect::<Vec<_>>(), prior_weight);
        (0..self.count())
            .map(|cell| {
                let shares = coarser.around(self.direction(cell));
                let prior = shares.iter().map(|&(cell, share)| coarse[cell] * share).sum::<Vec3>();
                (sums[cell].0 + prior * prior_weight) / (sums[cell].1 + prior_weight)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_contains_its_own_direction() {
        let sphere = DirectionGrid::with_rows(16);
        for cell in 0..sphere.count() {
            let around = sphere.around(sphere.direction(cell));
            let own: f32 = around.iter().filter(|(other, _)| *other == cell).map(|(_, share)| share).sum();
            assert!(own > 0.999, "{cell}: {around:?}");
        }
        let shares: f32 = sphere.around(Vec3::new(0.6, -0.8, 0.0)).iter().map(|(_, share)| share).sum();
        assert!((shares - 1.0).abs() < 1e-6);
    }

    #[test]
    fn interpolation_is_continuous_across_the_poles() {
        let sphere = DirectionGrid::with_rows(16);
        let value = |cell: usize| (cell * 7 % 11) as f32;
        for pole in [Vec3::Y, Vec3::NEG_Y] {
            let at = |step: f32| {
                let around = sphere.around((pole + Vec3::new(0.6, 0.0, -0.8) * step).normalize());
                around.iter().map(|&(cell, share)| value(cell) * share).sum::<f32>()
            };
            assert!((at(1e-5) - at(-1e-5)).abs() < 0.01 && (at(0.2) - at(-0.2)).abs() > 0.1);
        }
    }
}
