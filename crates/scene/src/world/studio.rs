//! A procedural photographer's studio: soft boxes in a grey room.

use glam::{DVec3, Vec3};
use numerics::smooth_fraction;

/// A soft box: a rectangular light with fading edges.
struct SoftBox {
    /// Direction to its middle; need not be unit.
    toward: DVec3,
    /// Half width and half height over the distance.
    half: [f64; 2],
    /// Radiance in its middle.
    radiance: f32,
}

/// Key light from the upper left front, fill from the right, a rim light from behind, and a ceiling. A white wall
/// facing the camera has a radiance near 1.
const SOFT_BOXES: [SoftBox; 4] = [
    SoftBox { toward: DVec3::new(-0.75, 0.75, 0.9), half: [0.5, 0.65], radiance: 3.9 },
    SoftBox { toward: DVec3::new(1.0, 0.25, 0.6), half: [0.35, 0.7], radiance: 1.4 },
    SoftBox { toward: DVec3::new(0.45, 0.6, -1.0), half: [0.6, 0.25], radiance: 2.4 },
    SoftBox { toward: DVec3::new(0.0, 1.0, 0.05), half: [0.5, 0.5], radiance: 1.2 },
];

pub(super) fn studio_radiance(direction: DVec3) -> Vec3 {
    // Walls, lighter above than below.
    let height = (direction.y as f32 + 1.0) / 2.0;
    let room = 0.16 + 0.3 * height * height;
    let boxes: f32 = SOFT_BOXES.iter().map(|soft_box| soft_box.radiance(direction)).sum();
    // Daylight is a little bluer from above.
    let tint = Vec3::new(0.985, 1.0, 1.02);
    Vec3::splat(boxes) + tint * room
}

impl SoftBox {
    fn radiance(&self, direction: DVec3) -> f32 {
        let toward = self.toward.normalize();
        let right = DVec3::Y.cross(toward).try_normalize().unwrap_or(DVec3::X);
        let up = toward.cross(right);
        let ahead = direction.dot(toward);
        if ahead <= 0.0 {
            return 0.0;
        }
        let across = [direction.dot(right) / ahead, direction.dot(up) / ahead];
        /// Width of the fading edge as a fraction of the half width.
        const FADE: f64 = 0.35;
        let inside = |at: f64, half: f64| smooth_fraction(((1.0 - at.abs() / half) / FADE).clamp(0.0, 1.0));
        let share = inside(across[0], self.half[0]) * inside(across[1], self.half[1]);
        self.radiance * share as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::World;

    /// Irradiance/π of a wall of this normal.
    fn white_wall(normal: DVec3) -> f64 {
        let (world, n) = (World::studio(), 200);
        let mut sum = 0.0;
        for k in 0..n * n {
            let (u, v) = (f64::from(k % n) + 0.5, f64::from(k / n) + 0.5);
            let (z, turn) = (1.0 - 2.0 * v / f64::from(n), std::f64::consts::TAU * u / f64::from(n));
            let flat = (1.0 - z * z).sqrt();
            let direction = DVec3::new(flat * turn.cos(), z, flat * turn.sin());
            sum += f64::from(world.radiance(direction).y) * normal.dot(direction).max(0.0);
        }
        sum * 4.0 / f64::from(n * n)
    }

    #[test]
    fn it_lights_well_from_the_front() {
        let walls = [DVec3::Z, DVec3::Y, DVec3::X, DVec3::NEG_X, DVec3::NEG_Z, DVec3::NEG_Y];
        let [front, top, right, left, back, below] = walls.map(white_wall);
        assert!((0.7..1.1).contains(&front), "{front}");
        assert!((0.6..1.4).contains(&top), "{top}");
        assert!([right, left, back].iter().all(|side| (0.3..1.2).contains(side)), "{right} {left} {back}");
        assert!((0.1..0.5).contains(&below), "{below}");
    }
}
