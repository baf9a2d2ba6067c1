//! Nodes, scenes, skins, cameras and lights.

use crate::gltf::container::json_object::Object;
use crate::gltf::document::Document;
use crate::gltf::geometry::accessor::{Accessor, Component};
use glam::DMat4;
use std::collections::HashMap;

pub(super) fn lint(document: &Document<'_>) {
    let nodes: Vec<Option<Object<'_>>> =
        (0..document.len("nodes")).map(|index| document.item("nodes", index, "").ok()).collect();
    let children: Vec<Vec<usize>> = (nodes.iter())
        .map(|node| node.as_ref().and_then(|node| node.indices("children").ok()).unwrap_or_default())
        .collect();
    let parents = lint_parents(document, &children);
    lint_cycles(document, &parents);
    for node in nodes.iter().flatten() {
        lint_transform(document, node);
        lint_mesh_and_skin(document, node);
    }
    for index in 0..document.len("scenes") {
        let Ok(scene) = document.item("scenes", index, "") else { continue };
        for node in scene.indices("nodes").unwrap_or_default() {
            if parents.get(node).is_some_and(Option::is_some) {
                document.warn(format!("{}/nodes: node {node} is not a root", scene.place));
            }
        }
    }
    (0..document.len("skins")).for_each(|index| lint_skin(document, index, &parents));
    (0..document.len("cameras")).for_each(|index| lint_camera(document, index));
    lint_lights(document);
}

/// The first parent of every node; warns about further ones.
fn lint_parents(document: &Document<'_>, children: &[Vec<usize>]) -> Vec<Option<usize>> {
    let mut parents = vec![None; children.len()];
    for (node, list) in children.iter().enumerate() {
        for &child in list {
            match parents.get_mut(child) {
                Some(parent @ None) => *parent = Some(node),
                Some(&mut Some(other)) if other != node => {
                    document.warn(format!(
                        "/nodes/{node}/children: node {child} has another parent, node {other}"
                    ));
                }
                _ => {}
            }
        }
    }
    parents
}

/// Warns about nodes that are their own ancestors.
fn lint_cycles(document: &Document<'_>, parents: &[Option<usize>]) {
    // 0: not visited; else the number of the walk that visited the node.
    let mut visited_in = vec![0; parents.len()];
    for start in 0..parents.len() {
        let (mut node, walk) = (Some(start), start + 1);
        while let Some(here) = node.filter(|&here| visited_in[here] == 0) {
            visited_in[here] = walk;
            node = parents[here];
        }
        if let Some(here) = node.filter(|&here| visited_in[here] == walk) {
            document.warn(format!("/nodes/{here}: is part of a cycle of nodes"));
        }
    }
}

fn lint_transform(document: &Document<'_>, node: &Object<'_>) {
    let trs = ["translation", "rotation", "scale"].iter().any(|key| node.get(key).is_some());
    if let Ok(Some(matrix)) = node.numbers::<16>("matrix") {
        if trs {
            document.warn(format!(
                "{}/matrix: is given together with translation, rotation or scale; the matrix counts",
                node.place
            ));
        }
        if !is_trs(DMat4::from_cols_array(&matrix)) {
            document.warn(format!("{}/matrix: is not made of translation, rotation and scale", node.place));
        }
    }
    if let Ok(Some(rotation)) = node.numbers::<4>("rotation") {
        let length = rotation.iter().map(|v| v * v).sum::<f64>().sqrt();
        if (length - 1.0).abs() > 5e-4 {
            document.warn(format!("{}/rotation: its length is {length}, not 1", node.place));
        }
    }
}

/// Whether a matrix is affine, with perpendicular axes other than zero.
fn is_trs(m: DMat4) -> bool {
    const TOLERANCE: f64 = 5e-4;
    let axes = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.truncate().normalize_or_zero());
    let bottom = [m.x_axis.w, m.y_axis.w, m.z_axis.w, m.w_axis.w - 1.0];
    bottom.iter().all(|v| v.abs() < TOLERANCE)
        && axes.iter().all(|axis| axis.length_squared() > 0.5)
        && (0..3).all(|i| axes[i].dot(axes[(i + 1) % 3]).abs() < TOLERANCE)
}

fn lint_mesh_and_skin(document: &Document<'_>, node: &Object<'_>) {
    let Ok(Some(mesh)) = node.index("mesh") else { return };
    let Ok(mesh) = document.item("meshes", mesh, "") else { return };
    let primitives = mesh.objects("primitives").unwrap_or_default();
    let is_skinned = |primitive: &Object<'_>| {
        primitive
            .object("attributes")
            .ok()
            .flatten()
            .is_some_and(|attributes| attributes.get("JOINTS_0").is_some())
    };
    if node.get("skin").is_some() && !primitives.iter().all(is_skinned) {
        document.warn(format!("{}/skin: its mesh has no JOINTS_0", node.place));
    }
    let targets = |primitive: &Object<'_>| primitive.list("targets").map_or(0, <[_]>::len);
    if let (Ok(Some(weights)), Some(primitive)) = (node.number_list("weights"), primitives.first())
        && weights.len() != targets(primitive)
    {
        let (n, m) = (weights.len(), targets(primitive));
        document.warn(format!("{}/weights: has {n} weights for {m} morph targets", node.place));
    }
}

fn lint_skin(document: &Document<'_>, index: usize, parents: &[Option<usize>]) {
    let Ok(skin) = document.item("skins", index, "") else { return };
    let joints = skin.indices("joints").unwrap_or_default();
    let Some(common) = common_ancestors(document, &joints, parents) else { return };
    if common.is_empty() {
        document.warn(format!("{}/joints: have no common root", skin.place));
    } else if let Ok(Some(skeleton)) = skin.index("skeleton")
        && !common.contains(&skeleton)
    {
        document.warn(format!("{}/skeleton: is not above all joints", skin.place));
    }
    let Ok(Some(bind)) = skin.index("inverseBindMatrices") else { return };
    let place = format!("{}/inverseBindMatrices", skin.place);
    let Ok(bind) = Accessor::open(document, bind, &place) else { return };
    if bind.shape.components() != 16 || bind.component != Component::F32 {
        return document.warn(format!("{place}: is not MAT4 of floats"));
    }
    if bind.count < joints.len() {
        document.warn(format!("{place}: has {} matrices for {} joints", bind.count, joints.len()));
    }
    let is_affine = |m: [f64; 16]| m[3] == 0.0 && m[7] == 0.0 && m[11] == 0.0 && m[15] == 1.0;
    let wrong = (0..bind.count.min(joints.len())).find(|&i| !is_affine(bind.doubles(i)));
    if let Some(i) = wrong {
        document.warn(format!("{place}: the last row of matrix {i} is not 0, 0, 0, 1"));
    }
}

/// The common ancestors of all joints, joints included; `None` if that takes too long.
fn common_ancestors(
    document: &Document<'_>,
    joints: &[usize],
    parents: &[Option<usize>],
) -> Option<Vec<usize>> {
    let mut below: HashMap<usize, usize> = HashMap::new();
    for &joint in joints {
        let (mut node, mut steps) = (Some(joint), 0);
        // A cycle would never end.
        while let Some(here) = node.filter(|_| steps <= parents.len()) {
            if !document.budget.try_take_checks(16) {
                return None;
            }
            *below.entry(here).or_default() += 1;
            steps += 1;
            node = parents.get(here).copied().flatten();
        }
    }
    Some(below.into_iter().filter(|&(_, count)| count >= joints.len()).map(|(node, _)| node).collect())
}

fn lint_camera(document: &Document<'_>, index: usize) {
    let Ok(camera) = document.item("cameras", index, "") else { return };
    if let Ok(Some(kind)) = camera.text("type")
        && ["orthographic", "perspective"].contains(&kind)
        && camera.get(kind).is_none()
    {
        document.warn(format!("{}: its {kind} is missing", camera.place));
    }
    for kind in ["orthographic", "perspective"] {
        let Ok(Some(lens)) = camera.object(kind) else { continue };
        let number = |key| lens.number(key).ok().flatten();
        if let (Some(near), Some(far)) = (number("znear"), number("zfar"))
            && far <= near
        {
            document.warn(format!("{}: zfar must be greater than znear", lens.place));
        }
    }
}

fn lint_lights(document: &Document<'_>) {
    let Ok(Some(lights)) = document.root_object().extension("KHR_lights_punctual") else { return };
    for light in lights.objects("lights").unwrap_or_default() {
        let kind = light.text("type").ok().flatten();
        let spot = light.object("spot").ok().flatten();
        match (kind, &spot) {
            (Some("spot"), None) => document.warn(format!("{}: its spot is missing", light.place)),
            (Some("spot"), Some(spot)) => {
                let angle = |key, default| spot.number(key).ok().flatten().unwrap_or(default);
                if angle("innerConeAngle", 0.0) >= angle("outerConeAngle", std::f64::consts::FRAC_PI_4) {
                    document.warn(format!("{}: the inner cone must be narrower than the outer", spot.place));
                }
            }
            _ => {}
        }
    }
}
