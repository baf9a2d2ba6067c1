//! Defects of the triangles, for the author of the file.

use crate::Scene;
use crate::model::inverted_faces::count_inverted_faces;
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

/// Counts over all triangles of a scene but those of splats. Corners at the same position count as one.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MeshHealth {
    /// All triangles.
    pub triangles: usize,
    /// Triangles without area.
    pub degenerate: usize,
    /// Triangles whose corners are those of an earlier one, in any order.
    pub duplicates: usize,
    /// Edges of one triangle only.
    pub boundary_edges: usize,
    /// Edges of more than two triangles.
    pub non_manifold_edges: usize,
    /// Triangles that face the inside of a closed mesh.
    #[serde(rename = "turned")]
    pub inverted: usize,
    /// Triangles whose part has no texture coordinates.
    pub without_uv: usize,
    /// Summed area.
    pub area: f64,
    /// Lower corner of the box around all triangles.
    pub low: [f64; 3],
    /// Upper corner of the box around all triangles.
    pub high: [f64; 3],
}

impl MeshHealth {
    /// Examines all triangles of `scene`. Sorts the edges: O(n log n).
    pub fn measure(scene: &Scene) -> Self {
        let welded = weld(&scene.positions);
        let mut edges = Vec::with_capacity(3 * scene.triangles.len());
        let mut corners = Vec::with_capacity(scene.triangles.len());
        let (low, high) = scene.bounds();
        let mut health = Self {
            triangles: scene.surface_triangles().len(),
            low: low.to_array(),
            high: high.to_array(),
            ..Self::default()
        };
        let surface = &scene.triangles[..scene.surface_triangles().end as usize];
        for (index, triangle) in surface.iter().enumerate() {
            let area = 0.5 * scene.area_normal(index as u32).length();
            health.area += area;
            health.degenerate += usize::from(area == 0.0);
            health.without_uv += usize::from(!scene.part_of(index as u32).has_uv[0]);
            let ids = triangle.vertices.map(|v| welded[v as usize]);
            for k in 0..3 {
                let (a, b) = (ids[k], ids[(k + 1) % 3]);
                if a != b {
                    edges.push((a.min(b), a.max(b)));
                }
            }
            corners.push(ids);
        }
        // A welded vertex is the lowest at its position.
        health.inverted = count_inverted_faces(&corners, |vertex| scene.positions[vertex as usize]);
        corners.par_iter_mut().for_each(|ids| ids.sort_unstable());
        corners.par_sort_unstable();
        health.duplicates = corners.windows(2).filter(|pair| pair[0] == pair[1]).count();
        edges.par_sort_unstable();
        for same in edges.chunk_by(|a, b| a == b) {
            health.boundary_edges += usize::from(same.len() == 1);
            health.non_manifold_edges += usize::from(same.len() > 2);
        }
        health
    }

    /// Whether all triangles lie in one point.
    pub fn is_point(&self) -> bool {
        self.low == self.high
    }
}

/// For each vertex the lowest vertex at exactly the same position.
fn weld(positions: &[DVec3]) -> Vec<u32> {
    // Adding zero unifies the two zeros.
    let key = |v: u32| (positions[v as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|&v| (key(v), v));
    let mut welded = vec![0; positions.len()];
    for same in order.chunk_by(|&a, &b| key(a) == key(b)) {
        for &v in same {
            welded[v as usize] = same[0];
        }
    }
    welded
}
