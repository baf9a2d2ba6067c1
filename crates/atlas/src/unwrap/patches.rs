//! Cutting a large connected mesh into compact patches, so that the engines' cost stays near-linear in the number of
//! triangles and patches can be unwrapped in parallel.
//!
//! Patches grow from spread-out seeds over the adjacency, nearest first, where a turn of the normal counts as
//! additional distance; then every seed moves to the middle of its patch and they grow again (Lloyd relaxation).

use crate::unwrap::part_mesh::{BORDER, PartMesh};
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Triangles of a patch. Larger ones have fewer seams; for a sphere of 81k triangles xatlas takes 4 s of processor
/// time in patches of 2500 and 2.5 s in patches of 1200.
pub(crate) const PATCH_TRIANGLES: usize = 1500;

/// Number of growths: one from the first seeds, the others after moving them.
const RELAXATION_ROUNDS: usize = 3;

/// Relative lengthening of a step that turns the normal 90° against the patch's.
const TURN_COST: f64 = 3.0;

/// Cuts a connected piece of a mesh. One of up to twice [`PATCH_TRIANGLES`] stays whole.
pub(crate) fn cut_into_patches(mesh: &PartMesh, piece: Vec<u32>) -> Vec<Vec<u32>> {
    if piece.len() <= 2 * PATCH_TRIANGLES {
        return vec![piece];
    }
    let count = piece.len().div_ceil(PATCH_TRIANGLES);
    // The piece is listed in traversal order, so equal steps in it are spread out.
    let mut seeds: Vec<u32> = (0..count).map(|i| piece[(2 * i + 1) * piece.len() / (2 * count)]).collect();
    let mut patches = Vec::new();
    for _ in 0..RELAXATION_ROUNDS {
        patches = grow_patches(mesh, &piece, &seeds);
        seeds = patches.iter().map(|patch| middle_of(mesh, patch)).collect();
    }
    patches
}

/// A triangle at a patch's growing front; nearest first in a heap.
struct FrontEntry {
    distance: f64,
    triangle: u32,
    patch: u32,
}

impl Ord for FrontEntry {
    fn cmp(&self, other: &Self) -> Ordering {
        let key = other.distance.total_cmp(&self.distance);
        key.then(other.triangle.cmp(&self.triangle)).then(other.patch.cmp(&self.patch))
    }
}
impl PartialOrd for FrontEntry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl PartialEq for FrontEntry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for FrontEntry {}

fn grow_patches(mesh: &PartMesh, piece: &[u32], seeds: &[u32]) -> Vec<Vec<u32>> {
    const UNREACHED: u32 = u32::MAX;
    let mut owner = vec![UNREACHED; mesh.triangles.len()];
    let normals: Vec<DVec3> = seeds.iter().map(|&s| normal_around(mesh, s)).collect();
    let seeds = seeds.iter().enumerate();
    let mut heap: BinaryHeap<FrontEntry> =
        seeds.map(|(i, &triangle)| FrontEntry { distance: 0.0, triangle, patch: i as u32 }).collect();
    let mut patches = vec![Vec::new(); heap.len()];
    while let Some(FrontEntry { distance, triangle, patch }) = heap.pop() {
        if owner[triangle as usize] != UNREACHED {
            continue;
        }
        owner[triangle as usize] = patch;
        patches[patch as usize].push(triangle);
        for neighbour in mesh.neighbours[triangle as usize] {
            if neighbour == BORDER || owner[neighbour as usize] != UNREACHED {
                continue;
            }
            let turn = 1.0 - mesh.area_normal(neighbour).normalize_or_zero().dot(normals[patch as usize]);
            let step = (mesh.middle(neighbour) - mesh.middle(triangle)).length() * (1.0 + TURN_COST * turn);
            heap.push(FrontEntry { distance: distance + step, triangle: neighbour, patch });
        }
    }
    debug_assert_eq!(patches.iter().map(Vec::len).sum::<usize>(), piece.len());
    // Two seeds on one triangle leave an empty patch.
    patches.retain(|patch| !patch.is_empty());
    patches
}

/// The mean normal of a triangle and its neighbours.
fn normal_around(mesh: &PartMesh, triangle: u32) -> DVec3 {
    let neighbours = mesh.neighbours[triangle as usize].into_iter().filter(|&n| n != BORDER);
    neighbours.chain([triangle]).map(|t| mesh.area_normal(t)).sum::<DVec3>().normalize_or_zero()
}

/// The triangle nearest to the mean position of a patch.
fn middle_of(mesh: &PartMesh, patch: &[u32]) -> u32 {
    let mean = patch.iter().map(|&t| mesh.middle(t)).sum::<DVec3>() / patch.len() as f64;
    let distance = |t: &&u32| (mesh.middle(**t) - mean).length_squared();
    *patch.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("patches are not empty")
}
