//! A scene's file as it is, and the origin in it of every part of the scene: for writing it again with additions.
//!
//! [`crate::Scene`] is flat and has only what a picture needs. Writing the file again must preserve the rest: here is
//! the document as in the file, with checked access to the data that it refers to.

use crate::Scene;
use crate::error::Fault;
use crate::gltf::document::Document;
use crate::gltf::geometry::accessor::Accessor;
use crate::gltf::geometry::primitive;
use crate::gltf::materials::image_file::mime_type;
use glam::DMat4;
use serde_json::Value;
use std::borrow::Cow;

/// The file of a scene.
pub struct GltfSource<'a> {
    pub(crate) document: &'a Document<'a>,
    /// The scene of the file, without its materials and defaults.
    pub scene: Scene,
    /// The origin of each of the scene's parts in the file.
    pub parts: Vec<PartSource>,
}

/// The origin of a part of a scene in its file.
#[derive(Clone, Debug, PartialEq)]
pub struct PartSource {
    /// The node.
    pub node: usize,
    /// The number of the node's instance, and its own matrix below the node; `None` for a node that is not instanced.
    pub instance: Option<(usize, DMat4)>,
    /// The node's mesh.
    pub mesh: usize,
    /// The primitive of the mesh.
    pub primitive: usize,
    /// For each vertex of the part, in the scene's order, its element in the primitive's accessors.
    pub vertices: Vec<u32>,
    /// The numbers of the primitive's triangles that it has; `None` if it has them all.
    pub triangles: Option<Vec<u32>>,
}

/// Elements of an accessor, as they are stored.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredElements {
    /// glTF's number of the component type.
    pub component: u32,
    /// Components of an element.
    pub components: usize,
    /// Bytes of an element, including a matrix's padding between columns.
    pub size: usize,
    /// The elements, one after another.
    pub bytes: Vec<u8>,
}

impl GltfSource<'_> {
    /// The JSON document, as it is in the file.
    pub fn document(&self) -> &Value {
        self.document.root_value()
    }

    /// The bytes of a buffer, as far as declared and present; `None` if the file does not contain its data.
    ///
    /// # Errors
    /// The buffer is faulty or its file cannot be read.
    pub fn buffer(&self, index: usize) -> Result<Option<&[u8]>, Fault> {
        match self.document.buffer(index, "/buffers") {
            Ok(bytes) => Ok(Some(bytes)),
            Err(Fault::NoData { .. }) => Ok(None),
            Err(fault) => Err(fault),
        }
    }

    /// The encoded bytes of an image with a `uri`, and their media type; `None` if they cannot be read or their type
    /// is unknown.
    pub fn image(&self, index: usize) -> Option<(Cow<'_, [u8]>, &'static str)> {
        let bytes = self.document.image_bytes(index, "/images").ok()?;
        let kind = mime_type(&bytes)?;
        Some((bytes, kind))
    }

    /// These elements of an accessor, its sparse replacements applied; zero if it has no data.
    ///
    /// # Errors
    /// The accessor is malformed, or the elements exceed the memory limit.
    pub fn elements(&self, accessor: usize, indices: &[u32]) -> Result<StoredElements, Fault> {
        let accessor = Accessor::open(self.document, accessor, "/meshes")?;
        let size = accessor.shape.size(accessor.component);
        self.document.budget.take_memory((size * indices.len()) as u64, &accessor.place)?;
        let mut bytes = vec![0; size * indices.len()];
        for (element, &index) in bytes.chunks_exact_mut(size).zip(indices) {
            if let Some(stored) =
                accessor.element(index as usize).filter(|_| (index as usize) < accessor.count)
            {
                element.copy_from_slice(&stored[..size]);
            }
        }
        self.document.budget.release_memory(bytes.len() as u64);
        let (component, components) = (accessor.component.as_gl_enum(), accessor.shape.components());
        Ok(StoredElements { component, components, size, bytes })
    }

    /// Number of vertices in a primitive's accessors: that of its positions.
    ///
    /// # Errors
    /// Its positions are malformed.
    pub fn vertex_count(&self, mesh: usize, primitive: usize) -> Result<u32, Fault> {
        let place = format!("/meshes/{mesh}/primitives/{primitive}/attributes/POSITION");
        let Some(accessor) = self.document.index_at(&place) else { return Ok(0) };
        Ok(Accessor::open(self.document, accessor, &place)?.count as u32)
    }

    /// All triangles of a primitive whose vertices exist, in order, shown or not.
    ///
    /// # Errors
    /// Its indices are malformed.
    pub fn triangles(&self, mesh: usize, primitive: usize) -> Result<Vec<[u32; 3]>, Fault> {
        let file = self.document.typed().meshes().nth(mesh);
        let file = file.and_then(|mesh| mesh.primitives().nth(primitive));
        file.map_or(Ok(Vec::new()), |file| {
            primitive::read_triangles(self.document, &file, &format!("/meshes/{mesh}/primitives/{primitive}"))
        })
    }
}
