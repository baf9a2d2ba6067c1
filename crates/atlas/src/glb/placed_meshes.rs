//! The meshes of the file, each with the place in the atlas of the node that shows it.
//!
//! Every instance of a mesh has a place of its own. The first keeps the mesh; each further one gets a copy that
//! shares all data with it except the new set and vertices split at seams. A node that shows a mesh many times by
//! EXT_mesh_gpu_instancing becomes the parent of one node per instance.

use crate::Atlas;
use crate::glb::glb_document::GlbDocument;
use crate::glb::placed_primitive;
use crate::glb::split_vertices::{Corner, SplitVertices};
use crate::glb::uv_set;
use glam::Vec2;
use progress::{Cancelled, Progress};
use scene::{Fault, GltfSource, PartSource, Scene};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The instancing extension: one mesh under many matrices.
const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// Why a mesh was not placed.
pub(crate) enum PlacementStop {
    /// The file is faulty.
    Fault(Fault),
    /// The file is not the one that the scene was read from.
    SourceMismatch,
    /// The work was cancelled.
    Cancelled,
}

impl From<Fault> for PlacementStop {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

impl From<Cancelled> for PlacementStop {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// Gives every mesh that the scene shows its place in the atlas.
pub(crate) fn place_meshes(
    glb: &mut GlbDocument,
    source: &GltfSource<'_>,
    atlas: &Atlas,
    progress: &dyn Progress,
) -> Result<(), PlacementStop> {
    let mut is_taken = vec![false; glb.entries("meshes").len()];
    let mut instances: BTreeMap<usize, Vec<Value>> = BTreeMap::new();
    let mut first = 0;
    let by_instance = |a: &PartSource, b: &PartSource| (a.node, a.instance) == (b.node, b.instance);
    for parts in source.parts.chunk_by(by_instance) {
        progress.check()?;
        progress.report(first as f32 / source.parts.len() as f32);
        let mut file = MeshFile { glb, source, atlas };
        let mesh = file.place_mesh(parts, first)?;
        first += parts.len();
        let PartSource { node, instance, mesh: index, .. } = &parts[0];
        let Some(is_taken) = is_taken.get_mut(*index) else { return Err(PlacementStop::SourceMismatch) };
        let index = match std::mem::replace(is_taken, true) {
            false => {
                glb.list("meshes")[*index] = mesh;
                *index
            }
            true => glb.push("meshes", mesh),
        };
        match instance {
            None => glb.list("nodes")[*node]["mesh"] = index.into(),
            Some((_, matrix)) => {
                let child = json!({ "mesh": index, "matrix": matrix.to_cols_array() });
                instances.entry(*node).or_default().push(child);
            }
        }
    }
    let has_instances = !instances.is_empty();
    instances.into_iter().for_each(|(node, children)| replace_instances(glb, node, children));
    if has_instances {
        glb.remove_unused_extension(INSTANCING);
    }
    glb.remove_unused_extension(placed_primitive::DRACO);
    Ok(())
}

/// Moves the node's mesh to children, one per instance, inserted before its existing children.
fn replace_instances(glb: &mut GlbDocument, node: usize, mut children: Vec<Value>) {
    let Some(parent) = glb.list("nodes")[node].as_object_mut() else { return };
    parent.remove("mesh");
    let weights = parent.remove("weights");
    if let Some(Value::Object(extensions)) = parent.get_mut("extensions") {
        extensions.remove(INSTANCING);
        if extensions.is_empty() {
            parent.remove("extensions");
        }
    }
    let inherited = [("name", parent.get("name").cloned()), ("weights", weights)];
    for (key, value) in inherited {
        if let Some(value) = value {
            children.iter_mut().for_each(|child| child[key] = value.clone());
        }
    }
    let indices: Vec<Value> = children.into_iter().map(|child| glb.push("nodes", child).into()).collect();
    let parent = &mut glb.list("nodes")[node];
    let own = parent.get("children").and_then(Value::as_array).cloned().unwrap_or_default();
    parent["children"] = indices.into_iter().chain(own).collect();
}

/// A mesh of the file, while it is being placed.
struct MeshFile<'a> {
    glb: &'a mut GlbDocument,
    source: &'a GltfSource<'a>,
    atlas: &'a Atlas,
}

impl MeshFile<'_> {
    /// The mesh of these parts of the scene, the first of which is part `first`.
    fn place_mesh(&mut self, parts: &[PartSource], first: usize) -> Result<Value, PlacementStop> {
        let file = self.source.document().pointer(&format!("/meshes/{}", parts[0].mesh));
        let mut mesh = file.cloned().ok_or(PlacementStop::SourceMismatch)?;
        let primitives =
            mesh.get_mut("primitives").and_then(Value::as_array_mut).ok_or(PlacementStop::SourceMismatch)?;
        let shown = parts.iter().filter_map(|part| primitives.get(part.primitive));
        let set = uv_set::atlas_set(shown, self.glb.entries("materials"));
        for (part, index) in parts.iter().zip(first..) {
            let triangles = self.triangles(part, index)?;
            let split = SplitVertices::new(&triangles, self.source.vertex_count(part.mesh, part.primitive)?);
            let primitive = primitives.get_mut(part.primitive).ok_or(PlacementStop::SourceMismatch)?;
            placed_primitive::place_primitive(primitive, self.glb, self.source, &split, set)?;
        }
        Ok(mesh)
    }

    /// All triangles of a part's primitive, with the atlas places of the corners of those that the scene shows.
    fn triangles(&self, part: &PartSource, index: usize) -> Result<Vec<[Corner; 3]>, PlacementStop> {
        let scene = &self.source.scene;
        let mut shown = shown_triangles(scene, part, index, self.atlas).into_iter().peekable();
        let all = self.source.triangles(part.mesh, part.primitive)?;
        let placed = all.into_iter().map(|triangle| {
            let is_shown = |shown: &[Corner; 3]| shown.map(|(element, _)| element) == triangle;
            shown.next_if(is_shown).unwrap_or_else(|| triangle.map(|element| (element, None)))
        });
        let placed: Vec<_> = placed.collect();
        if shown.next().is_some() { Err(PlacementStop::SourceMismatch) } else { Ok(placed) }
    }
}

/// The corners of a part's triangles, in the order of the file.
fn shown_triangles(scene: &Scene, part: &PartSource, index: usize, atlas: &Atlas) -> Vec<[Corner; 3]> {
    let size = Vec2::new(atlas.width as f32, atlas.height as f32);
    let scene_part = &scene.parts[index];
    let triangles = scene_part.triangles.clone();
    // A part's vertices are consecutive, and the first belongs to a triangle.
    let vertices = || scene.triangles[triangles.start as usize..triangles.end as usize].iter();
    let base = vertices().flat_map(|triangle| triangle.vertices).min().unwrap_or(0);
    let corners = |triangle: u32| {
        let vertices = scene.triangles[triangle as usize].vertices;
        let places = atlas.corners[triangle as usize];
        let corner = |k: usize| (part.vertices[(vertices[k] - base) as usize], Some(places[k] / size));
        // A mirrored part is oriented the other way round in the scene.
        if scene_part.mirrored {
            [corner(0), corner(2), corner(1)]
        } else {
            [corner(0), corner(1), corner(2)]
        }
    };
    triangles.clone().map(corners).collect()
}
