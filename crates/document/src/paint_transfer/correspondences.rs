//! Correspondences: for every texel of a new atlas, the position in the old atlas that it takes its paint from.

use crate::paint_transfer::alignment::{SAMPLE_COUNT, align};
use crate::paint_transfer::old_surface::OldSurface;
use atlas::{Atlas, TexelMap};
use glam::{DMat4, DVec2, DVec3};
use rayon::prelude::*;
use scene::Scene;
use std::collections::{BTreeMap, HashMap};

/// Maximum distance of corresponding points, as a share of the diagonal of the nodes of one name: coarse remeshing moves a surface by less.
const MAX_DISTANCE_SHARE: f64 = 0.03;

/// Minimum number of samples per node when the whole scene is aligned.
const MIN_SAMPLES_PER_NODE: usize = 8;

/// The painted surface of all nodes of one name.
struct NodeGroup {
    surface: OldSurface,
    bounds: (DVec3, DVec3),
    /// World transforms of its nodes, in order.
    worlds: Vec<DMat4>,
}

impl NodeGroup {
    fn new(old: &Scene, triangles: Vec<u32>, worlds: Vec<DMat4>) -> Self {
        let corners = triangles.iter().flat_map(|&triangle| old.corners(triangle));
        let bounds = bounding_box(corners);
        Self { surface: OldSurface::new(old, triangles.into_iter()), bounds, worlds }
    }

    fn extent(&self) -> f64 {
        (self.bounds.1 - self.bounds.0).length()
    }

    /// The motion from the new to the old world space, for a new surface with `bounds` and these points.
    fn motion(&self, points: &[(DVec3, DVec3)], bounds: (DVec3, DVec3), candidates: &[DMat4]) -> DMat4 {
        let centers = [self.bounds, bounds].map(|(low, high)| 0.5 * (low + high));
        align(&self.surface, points, candidates, centers, self.extent())
    }
}

fn bounding_box(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

/// For every new texel, in order, its position in the old atlas; `None` without a corresponding point. Nodes are matched by name; if no name
/// matches, the scenes are matched as a whole.
pub(crate) fn find_correspondences(
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
    let new_surface = TexelSurface { scene: new, texels };
    let whole_scene_motion = estimate_scene_motion(old, new_surface, &node_texels);

    let mut source_positions = vec![None; texels.texels.len()];
    for (node, texel_indices) in node_texels {
        let name = group_name(new, node);
        let Some(group) = old_groups.get(&name) else { continue };
        // Several nodes of one name are matched in order.
        let rank = (0..node).filter(|&earlier| group_name(new, earlier) == name).count();
        let node_motion =
            group.worlds.get(rank).map(|old_world| *old_world * new.nodes[node as usize].world.inverse());
        let candidates: Vec<DMat4> = node_motion.into_iter().chain([whole_scene_motion]).collect();
        let bounds = bounding_box(texel_indices.iter().map(|&texel| new_surface.position(texel)));
        let motion =
            group.motion(&new_surface.sample_points(&texel_indices, SAMPLE_COUNT), bounds, &candidates);
        let max_distance = MAX_DISTANCE_SHARE * group.extent();
        let node_positions: Vec<Option<DVec2>> = texel_indices
            .par_iter()
            .map(|&texel| {
                let position = motion.transform_point3(new_surface.position(texel));
                let normal = motion.transform_vector3(new_surface.normal(texel)).normalize_or_zero();
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

/// The painted surface, by the name of its nodes.
fn group_by_node_name(old: &Scene, group_name: &dyn Fn(&Scene, u32) -> String) -> HashMap<String, NodeGroup> {
    let mut contents_by_name: HashMap<String, (Vec<u32>, Vec<DMat4>)> = HashMap::new();
    for node in 0..old.nodes.len() as u32 {
        contents_by_name.entry(group_name(old, node)).or_default().1.push(old.nodes[node as usize].world);
    }
    for part in &old.parts {
        contents_by_name.entry(group_name(old, part.node)).or_default().0.extend(part.triangles.clone());
    }
    let with_surface = contents_by_name.into_iter().filter(|(_, (triangles, _))| !triangles.is_empty());
    with_surface.map(|(name, (triangles, worlds))| (name, NodeGroup::new(old, triangles, worlds))).collect()
}

/// The motion of all matched nodes together: it determines the rotation of round or flat objects, which their own shape does not.
fn estimate_scene_motion(old: &Scene, new: TexelSurface, node_texels: &[(u32, Vec<usize>)]) -> DMat4 {
    let group = NodeGroup::new(old, (0..old.triangles.len() as u32).collect(), Vec::new());
    let samples_per_node = (SAMPLE_COUNT / node_texels.len().max(1)).max(MIN_SAMPLES_PER_NODE);
    let points: Vec<_> = node_texels
        .iter()
        .flat_map(|(_, texel_indices)| new.sample_points(texel_indices, samples_per_node))
        .collect();
    let all_texels = node_texels.iter().flat_map(|(_, texel_indices)| texel_indices);
    group.motion(&points, bounding_box(all_texels.map(|&texel| new.position(texel))), &[])
}

/// What the texels of an atlas cover, in the world.
#[derive(Clone, Copy)]
struct TexelSurface<'a> {
    scene: &'a Scene,
    texels: &'a TexelMap,
}

impl TexelSurface<'_> {
    fn position(self, texel: usize) -> DVec3 {
        self.texels.texels[texel].centroid.position(self.scene)
    }

    /// The unit geometric normal; zero if the triangle's is not finite.
    fn normal(self, texel: usize) -> DVec3 {
        self.scene.area_normal(self.texels.texels[texel].centroid.triangle).normalize_or_zero()
    }

    /// About `sample_count` points of a node, with their normals.
    fn sample_points(self, texel_indices: &[usize], sample_count: usize) -> Vec<(DVec3, DVec3)> {
        let step = texel_indices.len().div_ceil(sample_count).max(1);
        let selected = texel_indices.iter().step_by(step);
        selected.map(|&texel| (self.position(texel), self.normal(texel))).collect()
    }
}
