//! An equirectangular environment map.

use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Radiance from every direction, with the convention of Blender and three.js for equirectangular pictures: the
/// middle column is toward +X, a quarter to its left −Z, a quarter to its right +Z; the top row is +Y.
///
/// Between texel centres radiance is bilinear in longitude and latitude; above the first row's centre and below the
/// last one's it is constant.
#[derive(Clone, PartialEq)]
pub struct EnvironmentMap {
    /// Its origin, for messages.
    pub name: String,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear RGB radiance, row by row, row 0 on top.
    pub texels: Vec<[f32; 3]>,
}

impl std::fmt::Debug for EnvironmentMap {
    /// Without its texels.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({} × {})", self.name, self.width, self.height)
    }
}

impl EnvironmentMap {
    /// A texel's radiance; columns wrap around, rows are clamped.
    #[inline]
    pub fn texel(&self, column: i64, row: i64) -> Vec3 {
        let x = column.rem_euclid(i64::from(self.width)) as usize;
        let y = row.clamp(0, i64::from(self.height) - 1) as usize;
        Vec3::from_array(self.texels[y * self.width as usize + x])
    }

    /// The position of a (unit) direction: texels from the upper left corner.
    pub fn texel_position(&self, direction: DVec3) -> DVec2 {
        let u = direction.z.atan2(direction.x) / TAU + 0.5;
        DVec2::new(u * f64::from(self.width), self.row_of_sine(direction.y))
    }

    /// The unit direction at a position of the map, px from its upper left corner.
    pub fn direction_at(&self, position: DVec2) -> DVec3 {
        let longitude = (position.x / f64::from(self.width) - 0.5) * TAU;
        let (y, flat) = self.row_latitude(position.y).sin_cos();
        DVec3::new(flat * longitude.cos(), y, flat * longitude.sin())
    }

    /// The latitude at a row's position, px from the top, in rad: π/2 at the top.
    pub fn row_latitude(&self, row: f64) -> f64 {
        FRAC_PI_2 - row / f64::from(self.height) * PI
    }

    /// The row, px from the top, at a latitude with this sine.
    pub fn row_of_sine(&self, sine: f64) -> f64 {
        (0.5 - sine.clamp(-1.0, 1.0).asin() / PI) * f64::from(self.height)
    }

    /// The radiance (linear RGB) from a unit direction in the environment's axes.
    pub fn radiance(&self, direction: DVec3) -> Vec3 {
        self.radiance_at(self.texel_position(direction))
    }

    /// The radiance (linear RGB) at a position of the map, px from its upper left corner.
    pub fn radiance_at(&self, position: DVec2) -> Vec3 {
        let at = position - 0.5;
        let low = at.floor();
        let share = (at - low).as_vec2();
        let (x, y) = (low.x as i64, low.y as i64);
        // A remainder takes longer than all else here.
        let width = i64::from(self.width);
        let wrapped = |x: i64| if (0..width).contains(&x) { x } else { x.rem_euclid(width) };
        let [left, right] = [wrapped(x), wrapped(x + 1)].map(|column| column as usize);
        let row = |y: i64| {
            let first = y.clamp(0, i64::from(self.height) - 1) as usize * self.width as usize;
            let texel = |column: usize| Vec3::from_array(self.texels[first + column]);
            texel(left).lerp(texel(right), share.x)
        };
        row(y).lerp(row(y + 1), share.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> EnvironmentMap {
        let texels = (0..8 * 4).map(|k| [k as f32, 0.0, 1.0]).collect();
        EnvironmentMap { name: "numbers".into(), width: 8, height: 4, texels }
    }

    #[test]
    fn directions_lie_as_in_blender_and_three_js() {
        let at = |direction: DVec3| map().texel_position(direction) / DVec2::new(8.0, 4.0);
        assert!(at(DVec3::X).abs_diff_eq(DVec2::new(0.5, 0.5), 1e-12));
        assert!(at(DVec3::NEG_Z).abs_diff_eq(DVec2::new(0.25, 0.5), 1e-12));
        assert!(at(DVec3::Z).abs_diff_eq(DVec2::new(0.75, 0.5), 1e-12));
        assert!(at(DVec3::Y).y.abs() < 1e-12 && (at(DVec3::NEG_Y).y - 1.0).abs() < 1e-12);
    }

    #[test]
    fn positions_and_directions_are_each_others_inverse() {
        for k in 0..200 {
            let position = DVec2::new(f64::from(k) * 0.7548 % 1.0 * 8.0, f64::from(k) * 0.5698 % 1.0 * 4.0);
            let direction = map().direction_at(position);
            assert!((direction.length() - 1.0).abs() < 1e-12);
            assert!(map().texel_position(direction).abs_diff_eq(position, 1e-9), "{position}");
        }
    }

    #[test]
    fn columns_wrap_and_rows_end_at_the_poles() {
        let map = map();
        let radiance = |x: f64, y: f64| map.radiance(map.direction_at(DVec2::new(x, y))).x;
        assert!((radiance(3.5, 1.5) - 11.0).abs() < 1e-5);
        assert!((radiance(0.0, 0.5) - 3.5).abs() < 1e-4, "between the last and the first column");
        assert!((radiance(2.5, 0.01) - 2.0).abs() < 1e-4);
        assert!(map.radiance(DVec3::Y).is_finite() && map.radiance(DVec3::NEG_Y).is_finite());
    }
}
