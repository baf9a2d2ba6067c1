//! The atlas itself.

use glam::{DVec2, Vec2};
use scene::SurfacePoint;
use sha2::{Digest, Sha256};
use std::ops::Range;

/// The place of every triangle of a scene in one texture. Texel coordinates: x right, y down, texel (i, j) is the
/// square [i, i+1] × [j, j+1].
///
/// Charts do not overlap and are at least [`crate::MIN_GUTTER`] empty texels apart. A triangle without area has a
/// place without area.
#[derive(Clone, Debug, PartialEq)]
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
    /// Hex SHA-256 of size and corners, by which focus maps name the atlas they belong to.
    pub hash: String,
    /// Texels per unit of world length (charts smaller than a texel are finer).
    pub density: f64,
    /// Deviations from the requested options, a sentence each. Not stored.
    pub notes: Vec<String>,
}

/// A connected piece of surface in the atlas.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// The part it belongs to.
    pub part: u32,
    /// Its bounding box in texels: columns, rows.
    pub bounds: [Range<u32>; 2],
}

impl Atlas {
    /// An atlas of these places; computes the charts' boxes and the hash. `part_of_chart` gives the part of each
    /// chart. Places must be finite, ≥ 0 and within the size.
    pub fn new(
        [width, height]: [u32; 2],
        corners: Vec<[Vec2; 3]>,
        chart_of: Vec<u32>,
        part_of_chart: &[u32],
        density: f64,
    ) -> Self {
        let mut boxes = vec![(Vec2::INFINITY, Vec2::NEG_INFINITY); part_of_chart.len()];
        for (triangle, &chart) in corners.iter().zip(&chart_of) {
            let (low, high) = &mut boxes[chart as usize];
            for &corner in triangle {
                *low = low.min(corner);
                *high = high.max(corner);
            }
        }
        let charts = part_of_chart
            .iter()
            .zip(boxes)
            .map(|(&part, (low, high))| {
                let range = |low: f32, high: f32, size: u32| {
                    if low > high {
                        return 0..0;
                    }
                    let start = (low as u32).min(size.saturating_sub(1));
                    start..(high.ceil() as u32).clamp(start + 1, size.max(start + 1))
                };
                Chart { part, bounds: [range(low.x, high.x, width), range(low.y, high.y, height)] }
            })
            .collect();
        let hash = hash_of(width, height, &corners);
        Self { width, height, corners, chart_of, charts, hash, density, notes: Vec::new() }
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.corners) + size_of_val(&*self.chart_of) + size_of_val(&*self.charts)
    }

    /// The position of a surface point in the atlas, in texels from the upper left corner.
    pub fn position_of(&self, point: SurfacePoint) -> DVec2 {
        let [a, b, c] = self.corners[point.triangle as usize].map(Vec2::as_dvec2);
        let [wa, wb, wc] = point.weights();
        a * wa + b * wb + c * wc
    }
}

/// SHA-256 over size and corners, little endian, as hex.
pub(crate) fn hash_of(width: u32, height: u32, corners: &[[Vec2; 3]]) -> String {
    let mut sha = Sha256::new();
    sha.update(width.to_le_bytes());
    sha.update(height.to_le_bytes());
    let mut buffer = Vec::with_capacity(24 * 1024);
    for block in corners.chunks(1024) {
        buffer.clear();
        buffer.extend(block.iter().flatten().flat_map(|c| [c.x, c.y]).flat_map(f32::to_le_bytes));
        sha.update(&buffer);
    }
    hex::encode(sha.finalize())
}
