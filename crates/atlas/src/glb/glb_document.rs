//! A scene's file being turned into a GLB: its document as it was, and one binary chunk.
//!
//! The chunk starts with all buffers of the file, byte for byte; added data follows. Images in separate files are
//! embedded, as a GLB may be moved elsewhere.

use crate::AtlasError;
use scene::{Fault, GltfSource, LoadOptions};
use serde_json::{Map, Value, json};

/// Alignment of everything in the chunk: that of the largest component type.
const ALIGNMENT: usize = 4;

/// Buffer view targets, glTF's numbers.
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// A document and its chunk.
pub(crate) struct GlbDocument {
    root: Map<String, Value>,
    chunk: Vec<u8>,
}

impl GlbDocument {
    /// Starts from the document of a file; its buffers and separate images go into the GLB's chunk.
    ///
    /// # Errors
    /// A buffer is faulty or cannot be read.
    pub fn from_source(source: &GltfSource<'_>) -> Result<Self, Fault> {
        let root = source.document().as_object().cloned().unwrap_or_default();
        let mut glb = Self { root, chunk: Vec::new() };
        glb.join_buffers(source)?;
        for index in 0..glb.entries("images").len() {
            glb.embed_image(source, index);
        }
        Ok(glb)
    }

    /// An empty document with an empty chunk.
    pub fn empty() -> Self {
        Self { root: Map::from_iter([("buffers".to_string(), json!([{}]))]), chunk: Vec::new() }
    }

    /// The JSON document, for modification.
    pub fn root_mut(&mut self) -> &mut Map<String, Value> {
        &mut self.root
    }

    /// Joins the buffers. One whose data is not available stays as it was, after the joined one.
    fn join_buffers(&mut self, source: &GltfSource<'_>) -> Result<(), Fault> {
        let mut joined = None;
        let mut separate = Vec::new();
        let mut moved = Vec::new();
        for (index, mut buffer) in self.entries("buffers").to_vec().into_iter().enumerate() {
            let Ok(Some(bytes)) = source.buffer(index) else {
                separate.push(buffer);
                moved.push(MovedBuffer { buffer: separate.len(), byte: 0 });
                continue;
            };
            let declared = index_member(&buffer, "byteLength").unwrap_or(0).max(bytes.len());
            if (declared - bytes.len()) as u64 > LoadOptions::default().max_memory {
                let what = format!("declares {declared} bytes, but there are {}", bytes.len());
                return Err(Fault::Malformed { place: format!("/buffers/{index}/byteLength"), what });
            }
            moved.push(MovedBuffer { buffer: 0, byte: self.append(bytes) });
            // Missing bytes must not be taken from what follows.
            self.chunk.resize(self.chunk.len() + declared - bytes.len(), 0);
            if let Some(buffer) = buffer.as_object_mut() {
                buffer.remove("uri");
            }
            joined.get_or_insert(buffer);
        }
        let joined = joined.unwrap_or_else(|| json!({}));
        self.root.insert("buffers".into(), std::iter::once(joined).chain(separate).collect());
        for view in self.root.get_mut("bufferViews").and_then(Value::as_array_mut).into_iter().flatten() {
            move_view(view, &moved);
            // Extensions that compress views name a buffer of their own for each.
            let extensions = view.get_mut("extensions").and_then(Value::as_object_mut);
            extensions.into_iter().flatten().for_each(|(_, extension)| move_view(extension, &moved));
        }
        Ok(())
    }

    /// Embeds an image from a separate file; one that is not available stays outside.
    fn embed_image(&mut self, source: &GltfSource<'_>, index: usize) {
        let uri = self.entries("images")[index].get("uri").and_then(Value::as_str);
        if uri.is_none_or(|uri| uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))) {
            return;
        }
        let Some((bytes, media_type)) = source.image(index) else { return };
        let view = self.add_view(&bytes, None);
        if let Some(image) = self.list("images")[index].as_object_mut() {
            image.remove("uri");
            image.insert("bufferView".into(), view.into());
            image.insert("mimeType".into(), media_type.into());
        }
    }

    /// The entries of the top-level list `key`; empty if missing.
    pub fn entries(&self, key: &str) -> &[Value] {
        self.root.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
    }

    /// The top-level list `key`, for modification; created if missing.
    pub fn list(&mut self, key: &str) -> &mut Vec<Value> {
        let list = self.root.entry(key).or_insert_with(|| json!([]));
        if !list.is_array() {
            *list = json!([]);
        }
        list.as_array_mut().expect("it is a list now")
    }

    /// Appends to the top-level list `key`; returns the index of the entry.
    pub fn push(&mut self, key: &str, value: Value) -> usize {
        let list = self.list(key);
        list.push(value);
        list.len() - 1
    }

    /// Appends bytes to the chunk; returns their offset.
    fn append(&mut self, bytes: &[u8]) -> usize {
        self.chunk.resize(self.chunk.len().next_multiple_of(ALIGNMENT), 0);
        self.chunk.extend(bytes);
        self.chunk.len() - bytes.len()
    }

    /// Appends bytes to the chunk; returns the index of their view.
    fn add_view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.append(bytes), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.push("bufferViews", view)
    }

    /// Appends data that is no part of a mesh; returns the index of its view.
    pub fn add_data_view(&mut self, bytes: &[u8]) -> usize {
        self.add_view(bytes, None)
    }

    /// Appends vertex indices to the chunk; returns the index of their buffer view.
    pub fn add_index_view(&mut self, bytes: &[u8]) -> usize {
        self.add_view(bytes, Some(ELEMENT_ARRAY_BUFFER))
    }

    /// Appends elements of `element_size` bytes as a vertex attribute, each of which must start aligned; returns the
    /// index of their view.
    pub fn add_vertex_view(&mut self, elements: &[u8], element_size: usize) -> usize {
        let stride = element_size.next_multiple_of(ALIGNMENT);
        if stride == element_size {
            return self.add_view(elements, Some(ARRAY_BUFFER));
        }
        let mut padded = vec![0; elements.len() / element_size * stride];
        for (to, from) in padded.chunks_exact_mut(stride).zip(elements.chunks_exact(element_size)) {
            to[..element_size].copy_from_slice(from);
        }
        let view = self.add_view(&padded, Some(ARRAY_BUFFER));
        self.list("bufferViews")[view]["byteStride"] = stride.into();
        view
    }

    /// Removes an extension that nothing in the document uses any more from the lists of extensions.
    pub fn remove_unused_extension(&mut self, name: &str) {
        const LISTS: [&str; 2] = ["extensionsUsed", "extensionsRequired"];
        if self.root.iter().any(|(key, value)| !LISTS.contains(&key.as_str()) && contains_key(value, name)) {
            return;
        }
        for key in LISTS {
            if let Some(list) = self.root.get_mut(key).and_then(Value::as_array_mut) {
                list.retain(|extension| extension != name);
                // glTF forbids empty lists.
                if list.is_empty() {
                    self.root.remove(key);
                }
            }
        }
    }

    /// The bytes of the GLB.
    ///
    /// # Errors
    /// They are more than a GLB can hold.
    pub fn into_bytes(mut self) -> Result<Vec<u8>, AtlasError> {
        self.append(&[]);
        let length = self.chunk.len();
        if let Some(joint) = self.list("buffers").first_mut() {
            joint["byteLength"] = length.into();
        }
        let mut text = Value::Object(self.root).to_string().into_bytes();
        text.resize(text.len().next_multiple_of(ALIGNMENT), b' ');
        let total = 12 + 8 + text.len() as u64 + 8 + length as u64;
        let total = u32::try_from(total).map_err(|_| AtlasError::GlbTooLarge { bytes: total })?;
        let mut bytes = Vec::with_capacity(total as usize);
        bytes.extend(b"glTF");
        bytes.extend([2, total].into_iter().flat_map(u32::to_le_bytes));
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(b"JSON");
        bytes.extend(text);
        bytes.extend((length as u32).to_le_bytes());
        bytes.extend(b"BIN\0");
        bytes.extend(self.chunk);
        Ok(bytes)
    }
}

/// Where a buffer of the file now is.
struct MovedBuffer {
    buffer: usize,
    /// Its byte offset there.
    byte: usize,
}

/// Redirects a view, or an object with the same members, to where its buffer now is.
fn move_view(view: &mut Value, moved: &[MovedBuffer]) {
    let Some(MovedBuffer { buffer, byte }) =
        index_member(view, "buffer").and_then(|buffer| moved.get(buffer))
    else {
        return;
    };
    view["buffer"] = (*buffer).into();
    if *byte > 0 {
        view["byteOffset"] = (index_member(view, "byteOffset").unwrap_or(0) + byte).into();
    }
}

fn index_member(object: &Value, key: &str) -> Option<usize> {
    as_index(object.get(key)?)
}

/// A whole number, which may be written as 2.0.
pub(crate) fn as_index(value: &Value) -> Option<usize> {
    let float = || value.as_f64().filter(|x| x.fract() == 0.0 && (0.0..9e15).contains(x)).map(|x| x as u64);
    usize::try_from(value.as_u64().or_else(float)?).ok()
}

fn contains_key(value: &Value, name: &str) -> bool {
    match value {
        Value::Object(members) => members.iter().any(|(key, value)| key == name || contains_key(value, name)),
        Value::Array(list) => list.iter().any(|value| contains_key(value, name)),
        _ => false,
    }
}
