//! A primitive of the file that gets the atlas as a UV set.
//!
//! If every vertex has one place in the atlas, the primitive stays as it is and gets one more attribute. If a seam
//! splits vertices, all of its attributes and those of its morph targets are rewritten, and its triangles become a
//! list.

use crate::glb::glb_document::GlbDocument;
use crate::glb::split_vertices::SplitVertices;
use crate::glb::uv_set;
use crate::glb::vertex_attributes::{VertexAttributes, add_indices, add_uv};
use glam::Vec2;
use scene::{Fault, GltfSource};
use serde_json::Value;

/// A compressed form that lacks the new set and numbers vertices in its own way. A file that opens also has the
/// uncompressed form.
pub(crate) const DRACO: &str = "KHR_draco_mesh_compression";

/// Gives `primitive` the atlas as UV set `set`: its vertices become those of `split`.
pub(crate) fn place_primitive(
    primitive: &mut Value,
    glb: &mut GlbDocument,
    source: &GltfSource<'_>,
    split: &SplitVertices,
    set: u64,
) -> Result<(), Fault> {
    let read = uv_set::sets_read(primitive, glb.entries("materials"));
    let mut attributes = primitive.get("attributes").and_then(Value::as_object).cloned().unwrap_or_default();
    if !split.is_unchanged {
        let mut vertices = VertexAttributes::new(source, &split.elements);
        attributes = vertices.rewrite(glb, &attributes)?;
        for target in primitive.get_mut("targets").and_then(Value::as_array_mut).into_iter().flatten() {
            if let Some(deltas) = target.as_object_mut() {
                *deltas = vertices.rewrite(glb, deltas)?;
            }
        }
        primitive["indices"] = add_indices(glb, &split.indices).into();
        // A primitive without a mode is a list of triangles.
        remove_key(primitive, "mode");
    }
    let atlas = add_uv(glb, &split.places);
    let zeros = || add_uv(glb, &vec![Vec2::ZERO; split.places.len()]);
    uv_set::insert_atlas_set(&mut attributes, set, &read, atlas, zeros);
    primitive["attributes"] = attributes.into();
    if let Some(extensions) = primitive.get_mut("extensions").filter(|all| all.get(DRACO).is_some()) {
        remove_key(extensions, DRACO);
        if extensions.as_object().is_none_or(|extensions| extensions.is_empty()) {
            remove_key(primitive, "extensions");
        }
    }
    Ok(())
}

fn remove_key(object: &mut Value, key: &str) {
    if let Some(object) = object.as_object_mut() {
        object.remove(key);
    }
}
