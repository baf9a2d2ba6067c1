//! A scene's file as it is, and where in it every part of the scene stands: for writing it again with something added.
//!
//! [`crate::Scene`] is flat and has only what a picture needs. What is written again must keep the rest: here is the
//! document as the file has it, and the checked way to the data that it refers to.

use crate::accessor::Accessor;
use crate::document::Document;
use crate::error::Fault;
use crate::image_file::mime_type;
use crate::{Scene, primitive};
use glam::DMat4;
use serde_json::Value;
use std::borrow::Cow;

/// The file of a scene.
pub struct GltfSource<'a> {
    pub(crate) document: &'a Document<'a>,
    /// The scene that the file makes, without its materials and what is made up.
    pub scene: Scene,
    /// Where each of the scene's parts stands.
    pub parts: Vec<PartSource>,
}

/// Where a part of a scene stands in its file.
#[derive(Clone, Debug, PartialEq)]
pub struct PartSource {
    /// The node.
    pub node: usize,
    /// Which of the node's instances, and its own matrix below the node; nothing for a node that is not instanced.
    pub instance: Option<(usize, DMat4)>,
    /// The node's mesh.
    pub mesh: usize,
    /// The primitive of the mesh.
    pub primitive: usize,
    /// Which element of the primitive's accessors each vertex of the part is, in the scene's order.
    pub vertices: Vec<u32>,
    /// Which of the primitive's shown triangles it has; nothing where it has them all.
    pub triangles: Option<Vec<u32>>,
}

/// Elements of an accessor, as they are stored.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredElements {
    /// glTF's number of the component type.
    pub component: u32,
    /// Components of an element.
    pub components: usize,
    /// Bytes of an element; those of a matrix include what its columns are padded with.
    pub size: usize,
    /// The elements, one behind the other.
    pub bytes: Vec<u8>,
}

impl GltfSource<'_> {
    /// The JSON document, as it is in the file.
    pub fn document(&self) -> &Value {
        self.document.root_value()
    }

    /// The bytes of a buffer, as far as they are declared and there; nothing for one whose data the file does not
    /// contain.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn buffer(&self, index: usize) -> Result<Option<&[u8]>, Fault> {
        match self.document.buffer(index, "/buffers") {
            Ok(bytes) => Ok(Some(bytes)),
            Err(Fault::NoData { .. }) => Ok(None),
            Err(fault) => Err(fault),
        }
    }

    /// The encoded bytes of an image that has a `uri`, and their media type; nothing if they cannot be had or are of
    /// no known type.
    pub fn image(&self, index: usize) -> Option<(Cow<'_, [u8]>, &'static str)> {
        let bytes = self.document.image_bytes(index, "/images").ok()?;
        let kind = mime_type(&bytes)?;
        Some((bytes, kind))
    }

    /// These elements of an accessor, its sparse replacements applied; zero where it has none.
    ///
    /// # Errors
    /// It is malformed, or they are more than may be held.
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

    /// How many vertices a primitive's accessors have: as many as its positions.
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
