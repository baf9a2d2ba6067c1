//! Rewriting vertex attributes: other elements of the accessors, each as it was stored.

use crate::glb::glb_document::{GlbDocument, as_index};
use glam::Vec2;
use scene::{Fault, GltfSource, StoredElements};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// glTF's numbers of component types.
const BYTE: u32 = 5120;
const UNSIGNED_BYTE: u32 = 5121;
const SHORT: u32 = 5122;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// Rewrites attributes for other vertices.
pub(crate) struct VertexAttributes<'a> {
    source: &'a GltfSource<'a>,
    /// For each vertex, its element in the accessors of the file.
    elements: &'a [u32],
    /// New accessors by those of the file: several attributes may share one.
    rewritten: BTreeMap<usize, usize>,
}

impl<'a> VertexAttributes<'a> {
    /// Rewrites attributes for vertices that are copies of the elements `elements`.
    pub fn new(source: &'a GltfSource<'a>, elements: &'a [u32]) -> Self {
        Self { source, elements, rewritten: BTreeMap::new() }
    }

    /// The attributes with new accessors. A malformed one is left out, as it is when the file is read.
    ///
    /// # Errors
    /// [`Fault::TooBig`] if a limit of loading is exceeded.
    pub fn rewrite(
        &mut self,
        glb: &mut GlbDocument,
        attributes: &Map<String, Value>,
    ) -> Result<Map<String, Value>, Fault> {
        let mut rewritten_attributes = Map::new();
        for (name, index) in attributes {
            let Some(index) = as_index(index) else { continue };
            let accessor = match self.rewritten.get(&index) {
                Some(accessor) => Ok(*accessor),
                None => self.accessor(glb, index, name == "POSITION"),
            };
            match accessor {
                Ok(accessor) => {
                    self.rewritten.insert(index, accessor);
                    rewritten_attributes.insert(name.clone(), accessor.into());
                }
                Err(fault @ Fault::TooBig { .. }) => return Err(fault),
                Err(_) => {}
            }
        }
        Ok(rewritten_attributes)
    }

    /// The new accessor of these vertices for accessor `index` of the file.
    fn accessor(&self, glb: &mut GlbDocument, index: usize, needs_bounds: bool) -> Result<usize, Fault> {
        let stored = self.source.elements(index, self.elements)?;
        let mut accessor = glb.entries("accessors").get(index).cloned().unwrap_or_else(|| json!({}));
        accessor["bufferView"] = glb.add_vertex_view(&stored.bytes, stored.size).into();
        accessor["count"] = self.elements.len().into();
        let had_bounds = ["min", "max"].iter().any(|key| accessor.get(key).is_some());
        if let Some(accessor) = accessor.as_object_mut() {
            ["byteOffset", "sparse", "min", "max"].iter().for_each(|key| drop(accessor.remove(*key)));
        }
        if needs_bounds || had_bounds {
            add_bounds(&mut accessor, &stored);
        }
        Ok(glb.push("accessors", accessor))
    }
}

/// Adds texture coordinates; returns the index of their accessor.
pub(crate) fn add_uv(glb: &mut GlbDocument, uv: &[Vec2]) -> usize {
    let bytes: Vec<u8> = uv.iter().flat_map(|uv| uv.to_array()).flat_map(f32::to_le_bytes).collect();
    let view = glb.add_vertex_view(&bytes, size_of::<[f32; 2]>());
    let accessor = json!({ "bufferView": view, "componentType": FLOAT, "type": "VEC2", "count": uv.len() });
    glb.push("accessors", accessor)
}

/// Adds the corners of triangles; returns the index of their accessor.
pub(crate) fn add_indices(glb: &mut GlbDocument, indices: &[u32]) -> usize {
    let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
    let view = glb.add_index_view(&bytes);
    let count = indices.len();
    let accessor =
        json!({ "bufferView": view, "componentType": UNSIGNED_INT, "type": "SCALAR", "count": count });
    glb.push("accessors", accessor)
}

/// The minimum and maximum stored value of every component, over the finite ones.
fn add_bounds(accessor: &mut Value, stored: &StoredElements) {
    let size = stored.size / stored.components.max(1);
    // Matrices with padding between their columns need no bounds.
    if stored.bytes.is_empty() || size != component_size(stored.component) {
        return;
    }
    let mut bounds = vec![[f64::INFINITY, f64::NEG_INFINITY]; stored.components];
    for element in stored.bytes.chunks_exact(stored.size) {
        for ([low, high], bytes) in bounds.iter_mut().zip(element.chunks_exact(size)) {
            let value = component(stored.component, bytes);
            if value.is_finite() {
                (*low, *high) = (low.min(value), high.max(value));
            }
        }
    }
    for (side, key) in ["min", "max"].into_iter().enumerate() {
        let values = bounds.iter().map(|bounds| match bounds[side] {
            value if !value.is_finite() => json!(0),
            value if stored.component == FLOAT => json!(value),
            whole => json!(whole as i64),
        });
        accessor[key] = values.collect();
    }
}

fn component_size(component: u32) -> usize {
    match component {
        BYTE | UNSIGNED_BYTE => 1,
        SHORT | UNSIGNED_SHORT => 2,
        _ => 4,
    }
}

/// A stored value.
fn component(component: u32, bytes: &[u8]) -> f64 {
    match (component, bytes) {
        (BYTE, &[a]) => f64::from(a as i8),
        (UNSIGNED_BYTE, &[a]) => f64::from(a),
        (SHORT, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
        (UNSIGNED_SHORT, &[a, b]) => f64::from(u16::from_le_bytes([a, b])),
        (UNSIGNED_INT, &[a, b, c, d]) => f64::from(u32::from_le_bytes([a, b, c, d])),
        (_, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
        _ => 0.0,
    }
}
