//! Meshes that a file holds compressed: what the rest reads is a document that holds them plainly.
//!
//! Compressed buffer views (`meshopt`) and primitives (`draco`) are decoded when the file is opened, into a buffer of its own that
//! the plain document has in addition. Where the file has the plain form as well, as it may where it does not require the
//! extension, that is read instead.

mod draco;
mod meshopt;

use crate::document::Document;
use crate::error::Fault;
use crate::json_object::integer;
use serde_json::{Map, Value, json};

/// The extensions that are taken out.
pub(crate) const EXTENSIONS: [&str; 3] =
    [draco::EXTENSION, "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// The plain document of one that may hold compressed meshes.
pub(crate) fn plain(document: Document<'_>) -> Result<Document<'_>, Fault> {
    let uses = |list: &str| {
        let names = document.value().get(list).and_then(Value::as_array).into_iter().flatten();
        names.filter_map(Value::as_str).any(|name| EXTENSIONS.contains(&name))
    };
    if !uses("extensionsUsed") && !uses("extensionsRequired") {
        return Ok(document);
    }
    let is_required = uses("extensionsRequired");
    // Primitives may lie in compressed views.
    [meshopt::decode, draco::decode].into_iter().try_fold(document, |document, decode| {
        let root = document.value().clone();
        let mut plain = Plain { root, bytes: Vec::new(), buffer: document.len("buffers") };
        decode(&document, &mut plain, is_required)?;
        if plain.bytes.is_empty() { Ok(document) } else { document.with(plain.root, plain.bytes) }
    })
}

/// The document that is being made.
struct Plain {
    root: Value,
    /// Of the buffer that is added.
    bytes: Vec<u8>,
    /// The index that it will have.
    buffer: usize,
}

impl Plain {
    /// Appends bytes; where they begin.
    fn append(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(8), 0);
        let start = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        start
    }

    /// Adds an entry to a collection; its index.
    fn add(&mut self, collection: &str, entry: Value) -> usize {
        let list = self.root.as_object_mut().map(|root| root.entry(collection).or_insert_with(|| json!([])));
        let Some(Value::Array(list)) = list else { return 0 };
        list.push(entry);
        list.len() - 1
    }

    /// Takes an extension from what is at `place`.
    fn forget(&mut self, place: &str, extension: &str) {
        let Some(Value::Object(entry)) = self.root.pointer_mut(place) else { return };
        if let Some(Value::Object(extensions)) = entry.get_mut("extensions") {
            extensions.remove(extension);
            if extensions.is_empty() {
                entry.remove("extensions");
            }
        }
    }
}

/// A non-negative integer of an object, 0 where it is absent.
fn number(object: &Map<String, Value>, key: &str, place: &str) -> Result<usize, Fault> {
    match object.get(key) {
        None => Ok(0),
        Some(value) => integer(value).and_then(|number| usize::try_from(number).ok()).ok_or_else(|| {
            Fault::Malformed { place: format!("{place}/{key}"), what: "is no index or size".into() }
        }),
    }
}
