//! For every texel of a new atlas, the place of the old one that it takes its paint from.

use super::alignment::{ASKED, aligned};
use super::old_surface::OldSurface;
use atlas::{Atlas, TexelMap};
use glam::{DMat4, DVec2, DVec3};
use rayon::prelude::*;
use scene::Scene;
use std::collections::{BTreeMap, HashMap};

/// How far a partner may be, as a share of the diagonal of what is called the same: coarse remeshing moves a surface by less.
const REACH: f64 = 0.03;

/// Of all of a scene a node is asked at no fewer points than these.
const ASKED_OF_NODE: usize = 8;

/// What was painted under a name.
struct Group {
    surface: OldSurface,
    bounds: (DVec3, DVec3),
    /// Where its nodes were, in their order.
    worlds: Vec<DMat4>,
}

impl Group {
    fn of(old: &Scene, triangles: Vec<u32>, worlds: Vec<DMat4>) -> Self {
        let corners = triangles.iter().flat_map(|&triangle| old.corners(triangle));
        let bounds = bounds_of(corners);
        Self { surface: OldSurface::new(old, triangles.into_iter()), bounds, worlds }
    }

    fn extent(&self) -> f64 {
        (self.bounds.1 - self.bounds.0).length()
    }

    /// The motion, old world from new, of a surface that has `bounds` and these points.
    fn motion(&self, points: &[(DVec3, DVec3)], bounds: (DVec3, DVec3), proposed: &[DMat4]) -> DMat4 {
        let middles = [self.bounds, bounds].map(|(low, high)| 0.5 * (low + high));
        aligned(&self.surface, points, proposed, middles, self.extent())
    }
}

fn bounds_of(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
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
    let mut texels_of: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    (0..texels.texels.len()).for_each(|texel| texels_of.entry(node_of(texel)).or_default().push(texel));
    let texels_of: Vec<(u32, Vec<usize>)> =
        texels_of.into_iter().filter(|(node, _)| groups.contains_key(&called(new, *node))).collect();
    let whole = whole_motion(old, texels, &texels_of);

    let mut found = vec![None; texels.texels.len()];
    for (node, of_node) in texels_of {
        let name = called(new, node);
        let Some(group) = groups.get(&name) else { continue };
        // Of several nodes of one name the same one is that of the same number.
        let rank = (0..node).filter(|&other| called(new, other) == name).count();
        let told = group.worlds.get(rank).map(|world| *world * new.nodes[node as usize].world.inverse());
        let proposed: Vec<DMat4> = told.into_iter().chain([whole]).collect();
        let bounds = bounds_of(of_node.iter().map(|&texel| texels.positions[texel]));
        let motion = group.motion(&sampled(texels, &of_node, ASKED), bounds, &proposed);
        let reach = REACH * group.extent();
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
    let mut of_name: HashMap<String, (Vec<u32>, Vec<DMat4>)> = HashMap::new();
    for node in 0..old.nodes.len() as u32 {
        of_name.entry(called(old, node)).or_default().1.push(old.nodes[node as usize].world);
    }
    for part in &old.parts {
        of_name.entry(called(old, part.node)).or_default().0.extend(part.triangles.clone());
    }
    let has_surface = of_name.into_iter().filter(|(_, (triangles, _))| !triangles.is_empty());
    has_surface.map(|(name, (triangles, worlds))| (name, Group::of(old, triangles, worlds))).collect()
}

/// The motion of all that has partners, as one: it tells how what is round or flat was turned.
fn whole_motion(old: &Scene, texels: &TexelMap, texels_of: &[(u32, Vec<usize>)]) -> DMat4 {
    let group = Group::of(old, (0..old.triangles.len() as u32).collect(), Vec::new());
    let asked = (ASKED / texels_of.len().max(1)).max(ASKED_OF_NODE);
    let points: Vec<_> = texels_of.iter().flat_map(|(_, of_node)| sampled(texels, of_node, asked)).collect();
    let all = texels_of.iter().flat_map(|(_, of_node)| of_node);
    group.motion(&points, bounds_of(all.map(|&texel| texels.positions[texel])), &[])
}

/// Points of a node, about `asked` of them, and which way they look.
fn sampled(texels: &TexelMap, of_node: &[usize], asked: usize) -> Vec<(DVec3, DVec3)> {
    let step = of_node.len().div_ceil(asked).max(1);
    let chosen = of_node.iter().step_by(step);
    chosen.map(|&texel| (texels.positions[texel], texels.normals[texel].as_dvec3())).collect()
}
