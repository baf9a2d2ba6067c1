//! Compressed primitives: KHR_draco_mesh_compression.

use super::plain_document::{PlainDocument, index_or_zero};
use crate::error::Fault;
use crate::gltf::container::json_object::as_whole_number;
use crate::gltf::document::Document;
use crate::gltf::geometry::accessor::{Component, Shape, component_from_code};
use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder, PointAttribute, PointIndex};
use serde_json::{Map, Value, json};

pub(super) const EXTENSION: &str = "KHR_draco_mesh_compression";

/// glTF's mode of triangles, whatever the primitive had.
const TRIANGLES: u32 = 4;

/// Gives each compressed primitive uncompressed accessors, unless it has an uncompressed form and the extension is
/// not required.
pub(super) fn decode(
    document: &Document<'_>,
    plain: &mut PlainDocument,
    is_required: bool,
) -> Result<(), Fault> {
    for mesh in 0..document.len("meshes") {
        let primitives = document.root_value().pointer(&format!("/meshes/{mesh}/primitives"));
        let count = primitives.and_then(Value::as_array).map_or(0, Vec::len);
        for index in 0..count {
            let place = format!("/meshes/{mesh}/primitives/{index}");
            let Some(primitive) = document.root_value().pointer(&place).and_then(Value::as_object) else {
                continue;
            };
            let Some(compressed) = primitive.get("extensions").and_then(|all| all.get(EXTENSION)) else {
                continue;
            };
            if is_required || !has_uncompressed_form(document, primitive) {
                let primitive_place = place;
                let place = format!("{primitive_place}/extensions/{EXTENSION}");
                let Some(compressed) = compressed.as_object() else {
                    return Err(Fault::Malformed { place, what: "is not an object".into() });
                };
                let compressed = DracoPrimitive { document, primitive, compressed, place };
                compressed.decode(plain, &primitive_place)?;
            }
        }
    }
    Ok(())
}

/// Whether the positions of a primitive lie in a buffer view.
fn has_uncompressed_form(document: &Document<'_>, primitive: &Map<String, Value>) -> bool {
    let position = primitive.get("attributes").and_then(|all| as_whole_number(all.get("POSITION")?));
    let accessor = position.and_then(|index| document.item("accessors", index as usize, "").ok());
    accessor.is_some_and(|accessor| accessor.get("bufferView").is_some())
}

struct DracoPrimitive<'a> {
    document: &'a Document<'a>,
    primitive: &'a Map<String, Value>,
    compressed: &'a Map<String, Value>,
    place: String,
}

impl DracoPrimitive<'_> {
    fn malformed(&self, key: &str, what: impl Into<String>) -> Fault {
        Fault::Malformed { place: format!("{}/{key}", self.place), what: what.into() }
    }

    fn decode(&self, plain: &mut PlainDocument, primitive: &str) -> Result<(), Fault> {
        let document = self.document;
        let view = index_or_zero(self.compressed, "bufferView", &self.place)?;
        let (encoded, _) = document.buffer_view(view, &format!("{}/bufferView", self.place))?;
        let options = &document.budget.options;
        let left = document.budget.memory_left();
        let limits = DecodeLimits::default()
            .with_max_points(options.max_triangles.saturating_mul(3))
            .with_max_faces(options.max_triangles)
            .with_max_decoded_bytes(left / 4);
        document.budget.take_work(encoded.len() as u64, &self.place)?;
        let mut mesh = Mesh::new();
        MeshDecoder::new().decode(&mut DecoderBuffer::new(encoded).with_limits(limits), &mut mesh).map_err(
            |error| {
                self.malformed("bufferView", format!("cannot be decoded: {error} (export the scene again)"))
            },
        )?;
        let points = mesh.num_points();
        let corners = mesh.faces().iter().flatten().map(|corner| corner.0);
        if corners.clone().any(|corner| corner as usize >= points) {
            return Err(self.malformed("bufferView", "refers to points that it does not have"));
        }
        document.budget.take_work(points as u64 + mesh.num_faces() as u64, &self.place)?;
        let bytes: Vec<u8> = corners.flat_map(u32::to_le_bytes).collect();
        let indices = json!({ "componentType": 5125, "type": "SCALAR", "count": bytes.len() / 4 });
        let indices = add_accessor(plain, document, &self.place, indices, &bytes)?;
        let mut attributes = Vec::new();
        let attribute_ids = self.compressed.get("attributes").and_then(Value::as_object);
        for (semantic, id) in attribute_ids.into_iter().flatten() {
            let place = format!("attributes/{semantic}");
            let id = as_whole_number(id).and_then(|id| u32::try_from(id).ok());
            let attribute = id.and_then(|id| mesh.attribute_by_unique_id(id));
            let attribute =
                attribute.ok_or_else(|| self.malformed(&place, "is not among the decoded attributes"))?;
            let (accessor, bytes) = self.accessor(semantic, attribute, points)?;
            attributes
                .push((semantic.clone(), add_accessor(plain, document, &self.place, accessor, &bytes)?));
        }
        plain.remove_extension(primitive, EXTENSION);
        if let Some(Value::Object(primitive)) = plain.root.pointer_mut(primitive) {
            primitive.insert("indices".into(), json!(indices));
            primitive.insert("mode".into(), json!(TRIANGLES));
            if let Some(Value::Object(all)) = primitive.get_mut("attributes") {
                all.extend(attributes.into_iter().map(|(semantic, accessor)| (semantic, json!(accessor))));
            }
        }
        Ok(())
    }

    /// An attribute in the format of the primitive's accessor for it, and its bytes.
    fn accessor(
        &self,
        semantic: &str,
        attribute: &PointAttribute,
        points: usize,
    ) -> Result<(Value, Vec<u8>), Fault> {
        let place = format!("attributes/{semantic}");
        let index = self.primitive.get("attributes").and_then(|all| as_whole_number(all.get(semantic)?));
        let Some(index) = index else {
            return Err(self.malformed(&place, "the primitive has no such attribute"));
        };
        let accessor = self.document.item("accessors", index as usize, &self.place)?;
        let component = accessor.get("componentType").and_then(as_whole_number).and_then(component_from_code);
        let shape = accessor.get("type").and_then(Value::as_str).and_then(Shape::from_name);
        let (Some(component), Some(shape)) = (component, shape.filter(|shape| !shape.is_matrix())) else {
            return Err(self.malformed(&place, "its accessor has no type"));
        };
        let components = shape.components();
        if usize::from(attribute.num_components()) != components {
            let what = format!("has {} components, its accessor {components}", attribute.num_components());
            return Err(self.malformed(&place, what));
        }
        self.document.budget.take_work((points * components) as u64, &self.place)?;
        let values = AttributeValues::new(attribute)
            .ok_or_else(|| self.malformed(&place, "has a type that glTF lacks"))?;
        let mut bytes = Vec::with_capacity(points * shape.size(component));
        let (mut low, mut high) = (vec![f64::INFINITY; components], vec![f64::NEG_INFINITY; components]);
        for point in 0..points {
            for k in 0..components {
                let value = values.get(point, k);
                (low[k], high[k]) = (low[k].min(value), high[k].max(value));
                append_component(component, value, &mut bytes);
            }
        }
        let mut plain = json!({
            "componentType": component.as_gl_enum(),
            "type": accessor.get("type").cloned(),
            "count": points,
        });
        if let Some(normalized) = accessor.get("normalized") {
            plain["normalized"] = normalized.clone();
        }
        if semantic == "POSITION" && points > 0 && low.iter().chain(&high).all(|bound| bound.is_finite()) {
            (plain["min"], plain["max"]) = (json!(low), json!(high));
        }
        Ok((plain, bytes))
    }
}

/// Adds an accessor of these bytes, in a new view.
fn add_accessor(
    plain: &mut PlainDocument,
    document: &Document<'_>,
    place: &str,
    mut accessor: Value,
    bytes: &[u8],
) -> Result<usize, Fault> {
    document.budget.take_memory(bytes.len() as u64, place)?;
    let (start, buffer) = (plain.append(bytes), plain.buffer);
    let view = json!({ "buffer": buffer, "byteOffset": start, "byteLength": bytes.len() });
    accessor["bufferView"] = json!(plain.add("bufferViews", view));
    document.budget.release_memory(bytes.len() as u64);
    Ok(plain.add("accessors", accessor))
}

/// The values of a decoded attribute.
struct AttributeValues<'a> {
    attribute: &'a PointAttribute,
    component: Component,
    stride: usize,
}

impl<'a> AttributeValues<'a> {
    fn new(attribute: &'a PointAttribute) -> Option<Self> {
        let component = match attribute.data_type() {
            DataType::Int8 => Component::I8,
            DataType::Uint8 | DataType::Bool => Component::U8,
            DataType::Int16 => Component::I16,
            DataType::Uint16 => Component::U16,
            DataType::Uint32 => Component::U32,
            DataType::Float32 => Component::F32,
            _ => return None,
        };
        Some(Self { attribute, component, stride: usize::try_from(attribute.byte_stride()).ok()? })
    }

    /// 0 if it does not exist.
    fn get(&self, point: usize, component: usize) -> f64 {
        let size = self.component.size();
        let value = self.attribute.mapped_index(PointIndex(point as u32)).0 as usize;
        let at = value.checked_mul(self.stride).and_then(|at| at.checked_add(component * size));
        let bytes = at.and_then(|at| self.attribute.buffer().data().get(at..at.checked_add(size)?));
        bytes.map_or(0.0, |bytes| crate::gltf::geometry::accessor::read_component(self.component, bytes))
    }
}

/// Appends a number in its stored form.
fn append_component(component: Component, value: f64, bytes: &mut Vec<u8>) {
    match component {
        Component::I8 => bytes.extend((value as i8).to_le_bytes()),
        Component::U8 => bytes.push(value as u8),
        Component::I16 => bytes.extend((value as i16).to_le_bytes()),
        Component::U16 => bytes.extend((value as u16).to_le_bytes()),
        Component::U32 => bytes.extend((value as u32).to_le_bytes()),
        Component::F32 => bytes.extend((value as f32).to_le_bytes()),
    }
}
