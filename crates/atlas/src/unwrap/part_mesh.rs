//! The mesh check: a part's triangles, welded, without those that no engine can handle, and with their neighbours.
//!
//! Triangles with a corner that is not finite and triangles without area are set aside as degenerate: they get a
//! place without area. Copies of a triangle (two-sided leaves, faces exported twice) would make their edges
//! non-manifold and shatter the mesh, so each further copy goes to a layer of its own, and every layer is a mesh.

use glam::DVec3;
use scene::Scene;
use std::collections::{HashMap, HashSet};

/// No neighbour across an edge.
pub(crate) const BORDER: u32 = u32::MAX;

/// Copies of a triangle beyond this many become charts of their own: such stacks are accidents, not surfaces.
const MAX_LAYERS: usize = 4;

/// A welded triangle mesh: (one layer of) a part.
#[derive(Clone, Debug, Default)]
pub(crate) struct PartMesh {
    /// The part.
    pub part: u32,
    /// Scene triangles; the other arrays are parallel to this one.
    pub triangles: Vec<u32>,
    /// Welded vertex positions, world space.
    pub positions: Vec<DVec3>,
    /// Each triangle's corners in `positions`.
    pub corners: Vec<[u32; 3]>,
    /// The triangle across edge k (corner k to k + 1), or [`BORDER`].
    pub neighbours: Vec<[u32; 3]>,
}

/// A part after the check.
#[derive(Debug, Default)]
pub(crate) struct CheckedPart {
    /// Its layers.
    pub meshes: Vec<PartMesh>,
    /// Scene triangles without area or with corners that are not finite.
    pub degenerate: Vec<u32>,
}

impl CheckedPart {
    /// Checks the part of the scene with this index for what engines cannot unwrap.
    pub fn new(scene: &Scene, part: u32) -> Self {
        let mut checked = Self::default();
        let mut copies: HashMap<[u32; 3], usize> = HashMap::new();
        let mut welder = Welder::default();
        let mut layers: Vec<Vec<(u32, [u32; 3])>> = Vec::new();
        for triangle in scene.parts[part as usize].triangles.clone() {
            let positions = scene.corners(triangle);
            let area = scene.area_normal(triangle).length();
            if !(positions.iter().all(|p| p.is_finite()) && area > 0.0 && area.is_finite()) {
                checked.degenerate.push(triangle);
                continue;
            }
            let corners = positions.map(|p| welder.vertex(p));
            let mut key = corners;
            key.sort_unstable();
            let count = copies.entry(key).or_default();
            // Beyond the last shared layer every copy opens one of its own.
            let layer = if *count < MAX_LAYERS { *count } else { layers.len() };
            *count += 1;
            if layers.len() <= layer {
                layers.resize_with(layer.max(MAX_LAYERS - 1) + 1, Vec::new);
            }
            layers[layer].push((triangle, corners));
        }
        let filled = layers.into_iter().filter(|layer| !layer.is_empty());
        checked.meshes = filled.map(|layer| PartMesh::new(part, layer, &welder.positions)).collect();
        checked
    }
}

/// Assigns one number to equal positions.
#[derive(Default)]
struct Welder {
    positions: Vec<DVec3>,
    number: HashMap<[u64; 3], u32>,
}

impl Welder {
    fn vertex(&mut self, position: DVec3) -> u32 {
        // Adding zero makes −0 and 0 the same.
        let key = (position + DVec3::ZERO).to_array().map(f64::to_bits);
        *self.number.entry(key).or_insert_with(|| {
            self.positions.push(position);
            self.positions.len() as u32 - 1
        })
    }
}

impl PartMesh {
    /// A mesh of these triangles (scene triangle, corners in `positions`); unused positions are dropped.
    fn new(part: u32, triangles: Vec<(u32, [u32; 3])>, positions: &[DVec3]) -> Self {
        let mut mesh = Self { part, ..Self::default() };
        let mut number: HashMap<u32, u32> = HashMap::new();
        for (triangle, corners) in triangles {
            let corners = corners.map(|corner| {
                *number.entry(corner).or_insert_with(|| {
                    mesh.positions.push(positions[corner as usize]);
                    mesh.positions.len() as u32 - 1
                })
            });
            mesh.triangles.push(triangle);
            mesh.corners.push(corners);
        }
        mesh.neighbours = neighbours(&mesh.corners);
        mesh
    }

    /// World positions of the corners of the triangle with this number.
    pub fn corner_positions(&self, triangle: u32) -> [DVec3; 3] {
        self.corners[triangle as usize].map(|v| self.positions[v as usize])
    }

    /// The triangle's geometric normal, whose length is twice its area (square scene units).
    pub fn area_normal(&self, triangle: u32) -> DVec3 {
        let [a, b, c] = self.corner_positions(triangle);
        (b - a).cross(c - a)
    }

    /// The centroid of a triangle, world.
    pub fn middle(&self, triangle: u32) -> DVec3 {
        self.corner_positions(triangle).iter().sum::<DVec3>() / 3.0
    }

    /// The connected pieces of a set of triangles, each in traversal order, the pieces in the order of their first
    /// triangle. A piece grows only to triangles for which `joins(first, triangle)` is true.
    pub fn connected_pieces(&self, triangles: &[u32], joins: impl Fn(u32, u32) -> bool) -> Vec<Vec<u32>> {
        // A set, not flags over the mesh: this is called for many small pieces of a large mesh.
        let mut waiting: HashSet<u32> = triangles.iter().copied().collect();
        let mut pieces = Vec::new();
        for &first in triangles {
            if !waiting.remove(&first) {
                continue;
            }
            let mut piece = vec![first];
            let mut next = 0;
            while let Some(&triangle) = piece.get(next) {
                next += 1;
                for neighbour in self.neighbours[triangle as usize] {
                    if waiting.contains(&neighbour) && joins(first, neighbour) {
                        waiting.remove(&neighbour);
                        piece.push(neighbour);
                    }
                }
            }
            pieces.push(piece);
        }
        pieces
    }
}

/// Neighbours across edges that exactly two triangles share, in opposite directions.
fn neighbours(corners: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut edges: Vec<(u32, u32, u32, bool)> = Vec::with_capacity(corners.len() * 3);
    for (t, c) in corners.iter().enumerate() {
        for k in 0..3 {
            let (from, to) = (c[k], c[(k + 1) % 3]);
            edges.push((from.min(to), from.max(to), (t * 3 + k) as u32, from < to));
        }
    }
    edges.sort_unstable();
    let mut result = vec![[BORDER; 3]; corners.len()];
    for same in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        if let &[(.., first, up), (.., second, also_up)] = same
            && up != also_up
        {
            result[first as usize / 3][first as usize % 3] = second / 3;
            result[second as usize / 3][second as usize % 3] = first / 3;
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_joins_two_triangles_of_one_orientation() {
        assert_eq!(neighbours(&[[0, 1, 2], [2, 1, 3]]), [[BORDER, 1, BORDER], [0, BORDER, BORDER]]);
        let flipped = [[0, 1, 2], [1, 2, 3]];
        let fan_of_three = [[0, 1, 2], [1, 0, 3], [1, 0, 4]];
        assert!(
            neighbours(&flipped).iter().chain(&neighbours(&fan_of_three)).flatten().all(|&n| n == BORDER)
        );
    }
}
