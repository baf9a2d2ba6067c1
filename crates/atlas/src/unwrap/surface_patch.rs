//! Input and output of an unwrapping engine.

use crate::unwrap::part_mesh::PartMesh;
use glam::DVec3;
use std::collections::HashMap;

/// The chart of triangles that an engine left out.
pub(crate) const UNPLACED: u32 = u32::MAX;

/// A connected mesh in f32, centred and scaled to a mean triangle area of 1 (engines have absolute limits).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SurfacePatch {
    /// Vertex positions.
    pub positions: Vec<[f32; 3]>,
    /// Triangles.
    pub corners: Vec<[u32; 3]>,
}

/// A patch in the plane, at any scale.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FlattenedPatch {
    /// The chart of each triangle, or [`UNPLACED`].
    pub chart: Vec<u32>,
    /// The corners of each triangle.
    pub corners: Vec<[[f32; 2]; 3]>,
}

impl FlattenedPatch {
    /// A result for this many triangles in which none has a place yet.
    pub fn unplaced(triangles: usize) -> Self {
        Self { chart: vec![UNPLACED; triangles], corners: vec![[[0.0; 2]; 3]; triangles] }
    }
}

impl SurfacePatch {
    /// The patch of some triangles (by number) of a mesh, scaled so that a triangle's mean area is 1.
    pub fn new(mesh: &PartMesh, triangles: &[u32]) -> Self {
        let area: f64 = triangles.iter().map(|&t| 0.5 * mesh.area_normal(t).length()).sum();
        let scale = (triangles.len() as f64 / area).sqrt();
        let center = mesh.middle(triangles[0]);
        let mut patch = Self { positions: Vec::new(), corners: Vec::with_capacity(triangles.len()) };
        let mut number: HashMap<u32, u32> = HashMap::new();
        for &triangle in triangles {
            let corners = mesh.corners[triangle as usize].map(|v| {
                *number.entry(v).or_insert_with(|| {
                    let position: DVec3 = (mesh.positions[v as usize] - center) * scale;
                    patch.positions.push(position.as_vec3().to_array());
                    patch.positions.len() as u32 - 1
                })
            });
            patch.corners.push(corners);
        }
        patch
    }
}
