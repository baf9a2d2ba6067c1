//! Regions of a picture that are connected in depth: they are filled and selected as objects of a scene are.
//!
//! The surface is cut where depth jumps, and continued behind occluders. Triangles that share corners are connected, including those of visible
//! and hidden surface. Specks, which noise in the depth cuts off, are merged with the region around them.

use glam::DVec3;
use scene::Scene;
use std::collections::HashMap;

/// Regions with a smaller area than this, in texels, are specks.
const SPECK_PX: f32 = 64.0;

/// The region of each triangle, numbered from 0 in order of their first triangles, and the number of regions. `corners` are those of the
/// triangles in texels.
pub(crate) fn triangle_regions(scene: &Scene, corners: &[[glam::Vec2; 3]]) -> (Vec<u32>, usize) {
    let mut sets = DisjointSets::new(scene.positions.len());
    let mut vertex_at_position: HashMap<[u64; 3], usize> = HashMap::with_capacity(scene.positions.len());
    for (vertex, position) in scene.positions.iter().enumerate() {
        let first = *vertex_at_position.entry(position_key(*position)).or_insert(vertex);
        sets.join(first, vertex);
    }
    for triangle in &scene.triangles {
        let [a, b, c] = triangle.vertices.map(|vertex| vertex as usize);
        sets.join(a, b);
        sets.join(b, c);
    }
    let mut roots: Vec<usize> =
        scene.triangles.iter().map(|triangle| sets.root(triangle.vertices[0] as usize)).collect();
    absorb_specks(&mut roots, corners);
    let mut numbers: HashMap<usize, u32> = HashMap::new();
    let numbered = roots.into_iter().map(|root| {
        let next = numbers.len() as u32;
        *numbers.entry(root).or_insert(next)
    });
    let regions = numbered.collect();
    (regions, numbers.len())
}

/// A key that is equal for equal positions, bit for bit except for the sign of zero.
fn position_key(position: DVec3) -> [u64; 3] {
    position.to_array().map(|x| (x + 0.0).to_bits())
}

/// Merges specks with the region that is most frequent around them in the picture.
fn absorb_specks(regions: &mut [usize], corners: &[[glam::Vec2; 3]]) {
    let mut area: HashMap<usize, f32> = HashMap::new();
    for (region, [a, b, c]) in regions.iter().zip(corners) {
        *area.entry(*region).or_default() += 0.5 * (*b - *a).perp_dot(*c - *a).abs();
    }
    let is_speck = |region: &usize| area[region] < SPECK_PX;
    // The region of each cell in which a large region has a corner.
    let cell = |corner: &glam::Vec2| [corner.x.round() as i32, corner.y.round() as i32];
    let mut region_at_cell: HashMap<[i32; 2], usize> = HashMap::new();
    for (region, corners) in regions.iter().zip(corners).filter(|(region, _)| !is_speck(region)) {
        region_at_cell.extend(corners.iter().map(|corner| (cell(corner), *region)));
    }
    let mut votes: HashMap<usize, HashMap<usize, u32>> = HashMap::new();
    for (region, corners) in regions.iter().zip(corners).filter(|(region, _)| is_speck(region)) {
        for [x, y] in corners.iter().map(cell) {
            let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [x + dx, y + dy]));
            for other in around.filter_map(|place| region_at_cell.get(&place)) {
                *votes.entry(*region).or_default().entry(*other).or_default() += 1;
            }
        }
    }
    let most_votes = |votes: &HashMap<usize, u32>| {
        votes
            .iter()
            .max_by_key(|(region, count)| (**count, std::cmp::Reverse(**region)))
            .map(|(region, _)| *region)
    };
    let reassigned: HashMap<usize, usize> =
        votes.iter().filter_map(|(speck, votes)| Some((*speck, most_votes(votes)?))).collect();
    for region in regions {
        *region = reassigned.get(region).copied().unwrap_or(*region);
    }
}

/// Disjoint sets of numbers (the least element is the root; path halving).
struct DisjointSets(Vec<usize>);

impl DisjointSets {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn root(&mut self, mut element: usize) -> usize {
        while self.0[element] != element {
            self.0[element] = self.0[self.0[element]];
            element = self.0[element];
        }
        element
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = (a.min(b), a.max(b));
        self.0[high] = low;
    }
}
