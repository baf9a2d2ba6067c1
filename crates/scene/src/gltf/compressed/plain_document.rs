//! The uncompressed document under construction.

use crate::error::Fault;
use crate::gltf::container::json_object::as_whole_number;
use serde_json::{Map, Value, json};

/// The document under construction.
pub(super) struct PlainDocument {
    pub root: Value,
    /// Content of the buffer that is added.
    pub bytes: Vec<u8>,
    /// Index of that buffer.
    pub buffer: usize,
}

impl PlainDocument {
    /// Appends bytes to the additional buffer; returns their offset in it.
    pub fn append(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(8), 0);
        let start = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        start
    }

    /// Adds an entry to a collection such as `bufferViews`; returns its index.
    pub fn add(&mut self, collection: &str, entry: Value) -> usize {
        let list = self.root.as_object_mut().map(|root| root.entry(collection).or_insert_with(|| json!([])));
        let Some(Value::Array(list)) = list else { return 0 };
        list.push(entry);
        list.len() - 1
    }

    /// Removes an extension from the object at `place`, a JSON pointer.
    pub fn remove_extension(&mut self, place: &str, extension: &str) {
        let Some(Value::Object(entry)) = self.root.pointer_mut(place) else { return };
        if let Some(Value::Object(extensions)) = entry.get_mut("extensions") {
            extensions.remove(extension);
            if extensions.is_empty() {
                entry.remove("extensions");
            }
        }
    }
}

/// A non-negative integer of an object, 0 if absent.
pub(super) fn index_or_zero(object: &Map<String, Value>, key: &str, place: &str) -> Result<usize, Fault> {
    match object.get(key) {
        None => Ok(0),
        Some(value) => {
            as_whole_number(value).and_then(|number| usize::try_from(number).ok()).ok_or_else(|| {
                Fault::Malformed { place: format!("{place}/{key}"), what: "is not an index or size".into() }
            })
        }
    }
}
