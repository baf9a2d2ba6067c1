//! Cells over all directions.

use glam::{Vec2, Vec3};

/// An equirectangular grid of directions: rows from +y down to −y, columns from −x eastward.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sphere {
    pub columns: usize,
    pub rows: usize,
}

impl Sphere {
    /// Twice as many columns as rows.
    pub fn of_rows(rows: usize) -> Self {
        Self { columns: 2 * rows, rows }
    }

    pub fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// The unit direction in the middle of a cell.
    pub fn direction(&self, cell: usize) -> Vec3 {
        let (x, y) = (cell % self.columns, cell / self.columns);
        let azimuth = ((x as f32 + 0.5) / self.columns as f32 - 0.5) * std::f32::consts::TAU;
        let polar = (y as f32 + 0.5) / self.rows as f32 * std::f32::consts::PI;
        let (sin, cos) = polar.sin_cos();
        Vec3::new(sin * azimuth.cos(), cos, sin * azimuth.sin())
    }

    /// The four cells around a unit direction and their shares, which sum to 1.
    pub fn around(&self, direction: Vec3) -> [(usize, f32); 4] {
        let azimuth = direction.z.atan2(direction.x) / std::f32::consts::TAU + 0.5;
        let polar = direction.y.clamp(-1.0, 1.0).acos() / std::f32::consts::PI;
        let at = Vec2::new(azimuth * self.columns as f32, polar * self.rows as f32) - 0.5;
        let floor = at.floor();
        let share = at - floor;
        let column = |x: i64| x.rem_euclid(self.columns as i64) as usize;
        let row = |y: i64| y.clamp(0, self.rows as i64 - 1) as usize;
        let (x, y) = (floor.x as i64, floor.y as i64);
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| {
            let across = if dx == 0 { 1.0 - share.x } else { share.x };
            let down = if dy == 0 { 1.0 - share.y } else { share.y };
            (row(y + dy) * self.columns + column(x + dx), across * down)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_lies_where_it_says() {
        let sphere = Sphere::of_rows(16);
        for cell in 0..sphere.count() {
            let around = sphere.around(sphere.direction(cell));
            let own: f32 = around.iter().filter(|(other, _)| *other == cell).map(|(_, share)| share).sum();
            assert!(own > 0.999, "{cell}: {around:?}");
        }
        let shares: f32 = sphere.around(Vec3::new(0.6, -0.8, 0.0)).iter().map(|(_, share)| share).sum();
        assert!((shares - 1.0).abs() < 1e-6);
    }
}
