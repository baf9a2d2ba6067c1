//! For every texel of a new atlas, the place of the old one that it takes its paint from.

use crate::paint_transfer::alignment::SAMPLE_COUNT;
use crate::paint_transfer::alignment::align;
use crate::paint_transfer::old_surface::OldSurface;
use atlas::{Atlas, TexelMap};
use glam::{DMat4, DVec2, DVec3};
use rayon::prelude::*;
use scene::Scene;
use std::collections::{BTreeMap, HashMap};

/// How far a partner may be, as a share of the diagonal of what is called the same: coarse remeshing moves a surface by less.
const MAX_DISTANCE_SHARE: f64 = 0.03;

/// Of all of a scene a node is asked at no fewer points than these.
const MIN_SAMPLES_PER_NODE: usize = 8;

/// What was painted under a name.
struct Group {
    surface: OldSurface,
    bounds: (DVec3, DVec3),
    /// Where its nodes were, in their order.
    worlds: Vec<DMat4>,
}

impl Group {
    fn new(old: &Scene, triangles: Vec<u32>, worlds: Vec<DMat4>) -> Self {
        let corners = triangles.iter().flat_map(|&triangle| old.corners(triangle));
        let bounds = bounding_box(corners);
        Self { surface: OldSurface::new(old, triangles.into_iter()), bounds, worlds }
    }

    fn extent(&self) -> f64 {
        (self.bounds.1 - self.bounds.0).length()
    }

    /// The motion, old world from new, of a surface that has `bounds` and these points.
    fn motion(&self, points: &[(DVec3, DVec3)], bounds: (DVec3, DVec3), candidates: &[DMat4]) -> DMat4 {
        let centers = [self.bounds, bounds].map(|(low, high)| 0.5 * (low + high));
        align(&self.surface, points, candidates, centers, self.extent())
    }
}

fn bounding_box(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

/// The places in the old atlas, in the order of the new texels; `None` where there is no partner. Nodes are the same by name; where no
/// name is the same, all of one scene is the same as all of the other.
pub fn find_correspondences(
    old: &Scene,
    old_atlas: &Atlas,
    new: &Scene,
    texels: &TexelMap,
) -> Vec<Option<DVec2>> {
    let has_name = |scene: &Scene, name: &str| scene.nodes.iter().any(|node| node.name == name);
    let is_matched_by_name = new.nodes.iter().any(|node| has_name(old, &node.name));
    let group_name = |scene: &Scene, node: u32| {
        if is_matched_by_name { scene.nodes[node as usize].name.clone() } else { String::new() }
    };

    let old_groups = group_by_node_name(old, &group_name);
    let node_of = |texel: usize| new.part_of(texels.texels[texel].centroid.triangle).node;
    let mut texels_of_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    (0..texels.texels.len()).for_each(|texel| texels_of_node.entry(node_of(texel)).or_default().push(texel));
    let node_texels: Vec<(u32, Vec<usize>)> = texels_of_node
        .into_iter()
        .filter(|(node, _)| old_groups.contains_key(&group_name(new, *node)))
        .collect();
    let whole_scene_motion = estimate_scene_motion(old, texels, &node_texels);

    let mut source_positions = vec![None; texels.texels.len()];
    for (node, texel_indices) in node_texels {
        let name = group_name(new, node);
        let Some(group) = old_groups.get(&name) else { continue };
        // Of several nodes of one name the same one is that of the same number.
        let rank = (0..node).filter(|&earlier| group_name(new, earlier) == name).count();
        let node_motion =
            group.worlds.get(rank).map(|old_world| *old_world * new.nodes[node as usize].world.inverse());
        let candidates: Vec<DMat4> = node_motion.into_iter().chain([whole_scene_motion]).collect();
        let bounds = bounding_box(texel_indices.iter().map(|&texel| texels.positions[texel]));
        let motion = group.motion(&sample_points(texels, &texel_indices, SAMPLE_COUNT), bounds, &candidates);
        let max_distance = MAX_DISTANCE_SHARE * group.extent();
        let node_positions: Vec<Option<DVec2>> = texel_indices
            .par_iter()
            .map(|&texel| {
                let position = motion.transform_point3(texels.positions[texel]);
                let normal = motion.transform_vector3(texels.normals[texel].as_dvec3()).normalize_or_zero();
                group
                    .surface
                    .nearest(position, normal, max_distance)
                    .map(|nearest| old_atlas.position_of(nearest.point))
            })
            .collect();
        texel_indices
            .into_iter()
            .zip(node_positions)
            .for_each(|(texel, source_position)| source_positions[texel] = source_position);
    }
    source_positions
}

/// What was painted, by the name of its node.
fn group_by_node_name(old: &Scene, group_name: &dyn Fn(&Scene, u32) -> String) -> HashMap<String, Group> {
    let mut contents_by_name: HashMap<String, (Vec<u32>, Vec<DMat4>)> = HashMap::new();
    for node in 0..old.nodes.len() as u32 {
        contents_by_name.entry(group_name(old, node)).or_default().1.push(old.nodes[node as usize].world);
    }
    for part in &old.parts {
        contents_by_name.entry(group_name(old, part.node)).or_default().0.extend(part.triangles.clone());
    }
    let with_surface = contents_by_name.into_iter().filter(|(_, (triangles, _))| !triangles.is_empty());
    with_surface.map(|(name, (triangles, worlds))| (name, Group::new(old, triangles, worlds))).collect()
}

/// The motion of all that has partners, as one: it tells how what is round or flat was turned.
fn estimate_scene_motion(old: &Scene, texels: &TexelMap, node_texels: &[(u32, Vec<usize>)]) -> DMat4 {
    let group = Group::new(old, (0..old.triangles.len() as u32).collect(), Vec::new());
    let samples_per_node = (SAMPLE_COUNT / node_texels.len().max(1)).max(MIN_SAMPLES_PER_NODE);
    let points: Vec<_> = node_texels
        .iter()
        .flat_map(|(_, texel_indices)| sample_points(texels, texel_indices, samples_per_node))
        .collect();
    let all_texels = node_texels.iter().flat_map(|(_, texel_indices)| texel_indices);
    group.motion(&points, bounding_box(all_texels.map(|&texel| texels.positions[texel])), &[])
}

/// Points of a node, about `asked` of them, and which way they look.
fn sample_points(texels: &TexelMap, texel_indices: &[usize], sample_count: usize) -> Vec<(DVec3, DVec3)> {
    let step = texel_indices.len().div_ceil(sample_count).max(1);
    let selected = texel_indices.iter().step_by(step);
    selected.map(|&texel| (texels.positions[texel], texels.normals[texel].as_dvec3())).collect()
}
