//! Meshes: names, formats and numbers of attributes, indices, morph targets, and what their materials require.

use super::vertex_data;
use crate::gltf::container::attribute_name::AttributeName;
use crate::gltf::container::json_object::Object;
use crate::gltf::document::Document;
use crate::gltf::extension;
use crate::gltf::geometry::accessor::{Accessor, Component, component_from_code};
use crate::gltf::geometry::splat_primitive;
use crate::gltf::materials::variants;
use std::collections::{HashMap, HashSet};

pub(super) fn lint(document: &Document<'_>) {
    let quantized = extension::used(document).any(|name| name == "KHR_mesh_quantization");
    let mut mesh_lint =
        MeshLint { document, quantized, views: HashMap::new(), vertex_accessors: HashMap::new() };
    for index in 0..document.len("meshes") {
        if let Ok(mesh) = document.item("meshes", index, "") {
            mesh_lint.lint_mesh(&mesh);
        }
    }
    mesh_lint.lint_shared_views();
}

#[derive(Clone, Copy, PartialEq)]
enum BufferRole {
    Vertices,
    Indices,
}

struct MeshLint<'a> {
    document: &'a Document<'a>,
    quantized: bool,
    /// What a buffer view is used for.
    views: HashMap<usize, BufferRole>,
    /// The vertex accessors of each buffer view without a stride.
    vertex_accessors: HashMap<usize, Vec<usize>>,
}

impl<'a> MeshLint<'a> {
    fn warn(&self, place: &str, what: impl std::fmt::Display) {
        self.document.warn(format!("{place}: {what}"));
    }

    fn lint_mesh(&mut self, mesh: &Object<'a>) {
        let primitives = mesh.objects("primitives").unwrap_or_default();
        let targets = |primitive: &Object<'_>| primitive.list("targets").map_or(0, <[_]>::len);
        let Some(expected) = primitives.first().map(targets) else { return };
        for primitive in &primitives {
            if targets(primitive) != expected {
                let count = targets(primitive);
                self.warn(
                    &primitive.place,
                    format!("has {count} morph targets, the mesh's first primitive {expected}"),
                );
            }
            self.lint_primitive(primitive);
        }
        if let Ok(Some(weights)) = mesh.number_list("weights")
            && weights.len() != expected
        {
            self.warn(&mesh.place, format!("has {} weights for {expected} morph targets", weights.len()));
        }
    }

    fn lint_primitive(&mut self, primitive: &Object<'a>) {
        let Ok(Some(attributes)) = primitive.object("attributes") else { return };
        self.lint_names(&attributes);
        let mut count = None;
        for (name, _) in attributes.entries() {
            let Some((place, index, accessor)) = self.accessor_object(&attributes, name) else { continue };
            self.lint_vertex_view(&place, index, &accessor);
            self.lint_format(&place, name, &accessor, false);
            let element_count = accessor.whole_number("count").ok().flatten();
            if count.is_some() && element_count.is_some() && element_count != count {
                self.warn(&place, "its number of elements differs from that of the other attributes");
            }
            count = count.or(element_count);
            if name == "POSITION" && (accessor.get("min").is_none() || accessor.get("max").is_none()) {
                self.warn(&place, "its accessor must have min and max");
            }
            if let Some(accessor) =
                Accessor::open(self.document, index, &place).ok().filter(Accessor::has_data)
            {
                vertex_data::lint_values(self.document, &place, name, &accessor);
            }
        }
        vertex_data::lint_weights(self.document, &attributes);
        self.lint_indices(primitive, count);
        for target in primitive.objects("targets").unwrap_or_default() {
            self.lint_target(&target, &attributes, count);
        }
        self.lint_material(primitive, &attributes);
        self.lint_mappings(primitive);
    }

    /// A variant may have one material.
    fn lint_mappings(&self, primitive: &Object<'a>) {
        let Ok(Some(variants)) = primitive.extension(variants::EXTENSION) else { return };
        let mut mapped = HashSet::new();
        for mapping in variants.objects("mappings").unwrap_or_default() {
            for variant in mapping.indices("variants").unwrap_or_default() {
                if !mapped.insert(variant) {
                    let what = format!("variant {variant} has a material already, which it keeps");
                    self.warn(&format!("{}/variants", mapping.place), what);
                }
            }
        }
    }

    /// The accessor that an attribute refers to.
    fn accessor_object(&self, owner: &Object<'a>, name: &str) -> Option<(String, usize, Object<'a>)> {
        let index = owner.index(name).ok()??;
        let accessor = self.document.item("accessors", index, "").ok()?;
        Some((format!("{}/{name}", owner.place), index, accessor))
    }

    fn lint_names(&self, attributes: &Object<'_>) {
        let mut sets: HashMap<&str, Vec<u32>> = HashMap::new();
        for (name, _) in attributes.entries() {
            match AttributeName::parse(name) {
                Some(AttributeName { base, set: Some(set) }) => sets.entry(base).or_default().push(set),
                Some(_) => {}
                None if name.starts_with(splat_primitive::EXTENSION) => {}
                None => self.warn(&format!("{}/{name}", attributes.place), "is not an attribute name"),
            }
        }
        for (base, mut sets) in sets.clone() {
            sets.sort_unstable();
            if sets.iter().enumerate().any(|(i, &set)| i != set as usize) {
                self.warn(&attributes.place, format!("the sets of {base} do not count from 0 without gaps"));
            }
        }
        let count = |base| sets.get(base).map_or(0, Vec::len);
        if count("JOINTS") != count("WEIGHTS") {
            self.warn(&attributes.place, "has a different number of sets of WEIGHTS than of JOINTS");
        }
    }

    /// Whether an accessor's type suits its attribute.
    fn lint_format(&self, place: &str, name: &str, accessor: &Object<'_>, target: bool) {
        use Component::{F32, I8, I16, U8, U16, U32};
        let Some(AttributeName { base, .. }) = AttributeName::parse(name) else { return };
        let component = accessor.whole_number("componentType").ok().flatten().and_then(component_from_code);
        let (Some(component), Ok(Some(shape))) = (component, accessor.text("type")) else { return };
        let normalized = accessor.flag("normalized").unwrap_or(false);
        if base.starts_with('_') {
            if component == U32 {
                self.warn(place, "attributes cannot be unsigned 32 bit integers");
            }
            return;
        }
        let float = component == F32;
        let signed = matches!(component, I8 | I16) && normalized;
        let unsigned = matches!(component, U8 | U16) && normalized;
        let small = matches!(component, I8 | I16 | U8 | U16);
        let fits = match (base, target) {
            ("POSITION", false) => shape == "VEC3" && (float || self.quantized && small),
            ("POSITION", true) => {
                shape == "VEC3" && (float || self.quantized && matches!(component, I8 | I16))
            }
            ("NORMAL", _) | ("TANGENT", true) => shape == "VEC3" && (float || self.quantized && signed),
            ("TANGENT", false) => shape == "VEC4" && (float || self.quantized && signed),
            ("TEXCOORD", _) => {
                shape == "VEC2" && (float || unsigned || self.quantized && small || target && signed)
            }
            ("COLOR", _) => ["VEC3", "VEC4"].contains(&shape) && (float || unsigned || target && signed),
            ("JOINTS", _) => shape == "VEC4" && matches!(component, U8 | U16) && !normalized,
            ("WEIGHTS", _) => shape == "VEC4" && (float || unsigned),
            _ => true,
        };
        if !fits {
            let code = accessor.whole_number("componentType").ok().flatten().unwrap_or(0);
            let kind = if normalized { "normalised " } else { "" };
            self.warn(place, format!("{shape} of {kind}{code} is not a valid format for {base}"));
        }
    }

    /// Alignment and exclusive use of the buffer view of a vertex accessor.
    fn lint_vertex_view(&mut self, place: &str, index: usize, accessor: &Object<'_>) {
        let component = accessor.whole_number("componentType").ok().flatten().and_then(component_from_code);
        let shape =
            accessor.text("type").ok().flatten().and_then(crate::gltf::geometry::accessor::Shape::from_name);
        let Some((view_index, view)) = self.lint_view(place, accessor, BufferRole::Vertices) else { return };
        let stride = view.whole_number("byteStride").ok().flatten();
        if stride.is_none() {
            let users = self.vertex_accessors.entry(view_index).or_default();
            if !users.contains(&index) {
                users.push(index);
            }
        }
        let (Some(component), Some(shape)) = (component, shape) else { return };
        let step = stride.unwrap_or(shape.size(component) as u64);
        let offset = accessor.whole_number("byteOffset").ok().flatten().unwrap_or(0);
        if step % 4 != 0 || !offset.is_multiple_of(4) {
            self.warn(place, "vertices must start at multiples of 4 bytes");
        }
    }

    /// The buffer view of an accessor; warns if it is also used in another role.
    fn lint_view(
        &mut self,
        place: &str,
        accessor: &Object<'_>,
        purpose: BufferRole,
    ) -> Option<(usize, Object<'a>)> {
        let index = accessor.index("bufferView").ok()??;
        let view = self.document.item("bufferViews", index, "").ok()?;
        let declared = match view.whole_number("target").ok().flatten() {
            Some(34962) => Some(BufferRole::Vertices),
            Some(34963) => Some(BufferRole::Indices),
            _ => None,
        };
        let first = *self.views.entry(index).or_insert(declared.unwrap_or(purpose));
        if first != purpose {
            self.warn(place, format!("{} is used for both vertices and indices", view.place));
        }
        Some((index, view))
    }

    /// Several vertex accessors in one view need a stride.
    fn lint_shared_views(&self) {
        let mut shared: Vec<usize> = self
            .vertex_accessors
            .iter()
            .filter(|(_, users)| users.len() > 1)
            .map(|(&view, _)| view)
            .collect();
        shared.sort_unstable();
        for view in shared {
            self.warn(
                &format!("/bufferViews/{view}"),
                "needs a byteStride, because several attributes share it",
            );
        }
    }

    fn lint_indices(&mut self, primitive: &Object<'a>, count: Option<u64>) {
        let Some((place, index, accessor)) = self.accessor_object(primitive, "indices") else { return };
        if let Some((_, view)) = self.lint_view(&place, &accessor, BufferRole::Indices)
            && view.get("byteStride").is_some()
        {
            self.warn(&place, "a view of indices cannot have a byteStride");
        }
        let code = accessor.whole_number("componentType").ok().flatten();
        let scalar = accessor.text("type").ok().flatten() == Some("SCALAR");
        if !scalar
            || !matches!(code, Some(5121 | 5123 | 5125))
            || accessor.flag("normalized").unwrap_or(false)
        {
            self.warn(&place, "indices must be SCALAR unsigned integers");
        }
        let Ok(accessor) = Accessor::open(self.document, index, &place) else { return };
        if accessor.shape.components() == 1 && accessor.has_data() {
            vertex_data::lint_indices(self.document, &place, &accessor, count.unwrap_or(u64::MAX));
        }
    }

    fn lint_target(&mut self, target: &Object<'a>, attributes: &Object<'a>, count: Option<u64>) {
        for (name, _) in target.entries() {
            let place = format!("{}/{name}", target.place);
            if AttributeName::parse(name).is_none() {
                self.warn(&place, "is not an attribute name");
            }
            if attributes.get(name).is_none() {
                self.warn(&place, "changes an attribute that the primitive does not have");
            }
            let Some((place, index, accessor)) = self.accessor_object(target, name) else { continue };
            self.lint_vertex_view(&place, index, &accessor);
            self.lint_format(&place, name, &accessor, true);
            let element_count = accessor.whole_number("count").ok().flatten();
            if count.is_some() && element_count.is_some() && element_count != count {
                self.warn(&place, "its number of elements differs from that of the attributes");
            }
        }
    }

    /// The texture coordinates that the material's textures need.
    fn lint_material(&self, primitive: &Object<'_>, attributes: &Object<'_>) {
        let Ok(Some(material)) = primitive.index("material") else { return };
        let Ok(material) = self.document.item("materials", material, "") else { return };
        let mut owners = vec![material.clone()];
        owners.extend(material.object("pbrMetallicRoughness").ok().flatten());
        let extensions = material.object("extensions").ok().flatten();
        for (name, _) in extensions.iter().flat_map(Object::entries) {
            owners.extend(material.extension(name).ok().flatten());
        }
        for owner in &owners {
            for (name, _) in owner.entries().filter(|(name, _)| name.ends_with("Texture")) {
                let Ok(Some(info)) = owner.object(name) else { continue };
                let transform = info.extension("KHR_texture_transform").ok().flatten();
                let transform_set =
                    transform.and_then(|transform| transform.whole_number("texCoord").ok().flatten());
                let texture_set = info.whole_number("texCoord").ok().flatten().unwrap_or(0);
                for set in [Some(texture_set), transform_set].into_iter().flatten() {
                    if attributes.get(&format!("TEXCOORD_{set}")).is_none() {
                        self.warn(
                            &primitive.place,
                            format!("{} needs TEXCOORD_{set}, which is missing", info.place),
                        );
                    }
                }
            }
        }
    }
}
