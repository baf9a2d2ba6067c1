//! A small light field for tests: a wall at 4 and, right of the middle, a card at 2 that hides part of it; the sky beyond the right edge.

use glam::{DVec2, Vec2, Vec3};
use lens::{Camera, FocusOffset};
use salf::{Salf, Sample, Visibility};
use surface::{SurfaceField, SurfacePoint};

/// Columns and rows.
pub const SIZE: [u32; 2] = [48, 32];

pub fn camera() -> Camera {
    Camera { width: SIZE[0], height: SIZE[1], focus_distance: 2.5, aperture_radius: 0.1, ..Camera::default() }
}

pub fn wall() -> Salf {
    let sample = |k: u32| {
        let [x, y] = [k % SIZE[0], k / SIZE[0]];
        let (depth, triangle) = if x < 24 { (4.0, Some(0)) } else { (2.0, Some(1)) };
        let (inverse_depth, triangle) = if x >= 44 { (0.0, None) } else { (1.0 / depth, triangle) };
        let barycentric = DVec2::new(f64::from(x) / 96.0, f64::from(y) / 64.0);
        // The wall beside the card is hidden from the right half of the aperture.
        let hides = if (20..24).contains(&x) { 0x0F0F_0F0F_0F0F_0F0F } else { u64::MAX };
        Sample {
            center: Vec2::new(x as f32, y as f32) + 0.5,
            half_size: Vec2::splat(0.5),
            inverse_depth,
            weight: 1.0,
            tilt: Vec2::ZERO,
            radiance: Vec3::new(0.1 + (x % 5) as f32 * 0.2, 0.5, (y % 7) as f32 * 0.1),
            surface: triangle.map(|triangle| SurfacePoint { triangle, barycentric }),
            is_carried: false,
            visibility: Visibility::from_words(&[hides]),
        }
    };
    let samples = (0..SIZE[0] * SIZE[1]).map(sample).collect();
    Salf::with_samples(camera(), samples)
}

/// The upper half of the wall is sharp, the lower half blurred.
pub struct PaintedWall;

impl SurfaceField<FocusOffset> for PaintedWall {
    fn at(&self, point: SurfacePoint) -> FocusOffset {
        match (point.triangle, point.barycentric.y < 0.25) {
            (0, true) => FocusOffset::SHARP,
            (0, false) => FocusOffset::new(1.02, 0.3),
            _ => FocusOffset::STANDARD,
        }
    }
    fn at_infinity(&self) -> FocusOffset {
        FocusOffset::STANDARD
    }
}
