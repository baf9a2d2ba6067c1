//! A surface for the tests: a strip that is cut into two charts, the second one turned and mirrored, and its back.

use focus::{Brush, BrushMode, Canvas, CanvasTexel, FocusMap, SurfaceHit};
use glam::{DVec3, Vec3};
use lens::FocusOffset;
use std::sync::Arc;

/// Texels a unit of length.
pub const DENSITY: u32 = 16;
pub const SIZE: [u32; 2] = [90, 80];

/// The strip [0, 4] × [0, 1] at z = 0, facing +z, and behind it (z = −0.05) one facing −z. Charts: left and
/// right half of the front, the back.
pub fn strip() -> Arc<Canvas> {
    let mut texels = Vec::new();
    let mut gutters = Vec::new();
    let mut put = |x: u32, y: u32, position: DVec3, normal: Vec3, chart: u32| {
        let area = 1.0 / (DENSITY * DENSITY) as f64;
        let part = u32::from(chart == 2);
        texels.push(CanvasTexel { x, y, position, normal, area, part, chart });
    };
    let at = |i: u32, j: u32| {
        DVec3::new((i as f64 + 0.5) / DENSITY as f64, 1.0 - (j as f64 + 0.5) / DENSITY as f64, 0.0)
    };
    for j in 0..DENSITY {
        for i in 0..4 * DENSITY {
            if i < 2 * DENSITY {
                put(2 + i, 2 + j, at(i, j), Vec3::Z, 0);
            } else {
                put(40 + j, 22 + (4 * DENSITY - 1 - i), at(i, j), Vec3::Z, 1);
            }
            put(4 + i, 60 + j, at(i, j) - DVec3::Z * 0.05, -Vec3::Z, 2);
        }
        gutters.push([[1, 2 + j], [2, 2 + j]]);
        gutters.push([[2 + 2 * DENSITY, 2 + j], [1 + 2 * DENSITY, 2 + j]]);
    }
    Arc::new(Canvas::from_texels(SIZE, texels, &gutters, vec![[0, 0], [1, 0]]))
}

pub fn blank() -> FocusMap {
    FocusMap::new(SIZE[0], SIZE[1], FocusOffset::STANDARD)
}

pub fn hit(x: f64, y: f64) -> SurfaceHit {
    SurfaceHit { position: DVec3::new(x, y, 0.0), normal: Some(Vec3::Z) }
}

pub fn brush(mode: BrushMode) -> Brush {
    Brush { radius: 0.25, mode, target: FocusOffset::new(1.5, 0.75), ..Brush::default() }
}
