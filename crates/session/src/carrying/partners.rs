//! For every texel of a new atlas, the place of the old one that it takes its paint from.

use super::alignment::{ASKED, aligned};
use super::old_surface::OldSurface;
use atlas::{Atlas, TexelMap};
use glam::{DMat4, DVec2, DVec3};
use rayon::prelude::*;
use scene::Scene;
use std::collections::HashMap;

/// How far a partner may be, as a share of the diagonal of what is called the same: coarse remeshing moves a surface by less.
const REACH: f64 = 0.03;

/// A node's surface of old: what of that name was painted.
struct Group {
    surface: OldSurface,
    bounds: (DVec3, DVec3),
    worlds: Vec<DMat4>,
}

/// The places in the old atlas, in the order of the new texels; `None` where there is no partner. Nodes are the same by name; where no
/// name is the same, all of one scene is the same as all of the other.
pub fn partners(old: &Scene, old_atlas: &Atlas, new: &Scene, texels: &TexelMap) -> Vec<Option<DVec2>> {
    let has_name = |scene: &Scene, name: &str| scene.nodes.iter().any(|node| node.name == name);
    let by_name = new.nodes.iter().any(|node| has_name(old, &node.name));
    let called = |scene: &Scene, node: u32| {
        if by_name { scene.nodes[node as usize].name.clone() } else { String::new() }
    };

    let groups = groups(old, &called);
    let node_of = |texel: usize| new.part_of(texels.texels[texel].centroid.triangle).node;
    let mut texels_of: HashMap<u32, Vec<usize>> = HashMap::new();
    (0..texels.texels.len()).for_each(|texel| texels_of.entry(node_of(texel)).or_default().push(texel));

    let mut found = vec![None; texels.texels.len()];
    for (node, of_node) in texels_of {
        let name = called(new, node);
        let Some(group) = groups.get(&name) else { continue };
        // Of several nodes of one name the same one is that of the same number.
        let rank = (0..node).filter(|&other| called(new, other) == name).count();
        let told = group.worlds.get(rank).map(|world| *world * new.nodes[node as usize].world.inverse());
        let motion = motion(group, texels, &of_node, told);
        let reach = REACH * (group.bounds.1 - group.bounds.0).length();
        let places: Vec<Option<DVec2>> = of_node
            .par_iter()
            .map(|&texel| {
                let at = motion.transform_point3(texels.positions[texel]);
                let normal = motion.transform_vector3(texels.normals[texel].as_dvec3()).normalize_or_zero();
                group.surface.nearest(at, normal, reach).map(|nearest| old_atlas.position_of(nearest.point))
            })
            .collect();
        of_node.into_iter().zip(places).for_each(|(texel, place)| found[texel] = place);
    }
    found
}

/// What was painted, by the name of its node.
fn groups(old: &Scene, called: &dyn Fn(&Scene, u32) -> String) -> HashMap<String, Group> {
    let mut triangles: HashMap<String, (Vec<u32>, Vec<DMat4>)> = HashMap::new();
    for node in 0..old.nodes.len() as u32 {
        triangles.entry(called(old, node)).or_default().1.push(old.nodes[node as usize].world);
    }
    for part in &old.parts {
        triangles.entry(called(old, part.node)).or_default().0.extend(part.triangles.clone());
    }
    let group = |(name, (triangles, worlds)): (String, (Vec<u32>, Vec<DMat4>))| {
        let corners = triangles.iter().flat_map(|&triangle| old.corners(triangle));
        let bounds =
            corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        (name, Group { surface: OldSurface::new(old, triangles.into_iter()), bounds, worlds })
    };
    triangles.into_iter().filter(|(_, (triangles, _))| !triangles.is_empty()).map(group).collect()
}

/// The motion, old world from new, of a node's texels.
fn motion(group: &Group, texels: &TexelMap, of_node: &[usize], told: Option<DMat4>) -> DMat4 {
    let bounds = of_node.iter().map(|&texel| texels.positions[texel]);
    let (low, high) =
        bounds.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let step = of_node.len().div_ceil(ASKED).max(1);
    let sampled: Vec<_> = (of_node.iter().step_by(step))
        .map(|&texel| (texels.positions[texel], texels.normals[texel].as_dvec3()))
        .collect();
    let middles = [0.5 * (group.bounds.0 + group.bounds.1), 0.5 * (low + high)];
    let extent = (group.bounds.1 - group.bounds.0).length();
    aligned(&group.surface, &sampled, told.as_slice(), middles, extent)
}
