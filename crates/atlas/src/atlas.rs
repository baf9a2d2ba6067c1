//! The atlas itself.

use glam::{DVec2, Vec2};
use scene::{Scene, SurfacePoint};
use std::ops::Range;

/// Where every triangle of a scene lies in one texture. Texel coordinates: x right, y down, texel (i, j) is
/// the square [i, i+1] × [j, j+1].
#[derive(Clone, Debug)]
pub struct Atlas {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// For each scene triangle, its corners in texel coordinates. Charts do not overlap.
    pub corners: Vec<[Vec2; 3]>,
    /// For each scene triangle, its chart.
    pub chart_of: Vec<u32>,
    /// The charts.
    pub charts: Vec<Chart>,
    /// Hex SHA-256 of size and corners: focus maps name the atlas they belong to by it.
    pub hash: String,
}

/// A connected piece of surface in the atlas.
#[derive(Clone, Debug)]
pub struct Chart {
    /// The part it belongs to.
    pub part: u32,
    /// Its box in texels, x and y.
    pub bounds: [Range<u32>; 2],
}

/// What a texel covers.
#[derive(Clone, Copy, Debug)]
pub struct AtlasTexel {
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
    /// Exact world area of texel ∩ surface.
    pub area: f64,
    /// The surface point at the centroid of what it covers (of its largest piece where it covers several).
    pub centroid: SurfacePoint,
}

impl Atlas {
    /// The atlas position of a surface point, in texel coordinates.
    pub fn position_of(&self, point: SurfacePoint) -> DVec2 {
        let [a, b, c] = self.corners[point.triangle as usize].map(Vec2::as_dvec2);
        let [wa, wb, wc] = point.weights();
        a * wa + b * wb + c * wc
    }

    /// Every texel that covers some surface, in row order.
    pub fn texels(&self, _scene: &Scene) -> Vec<AtlasTexel> {
        todo!()
    }
}
