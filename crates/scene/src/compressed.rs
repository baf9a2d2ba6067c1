//! Meshes that a file holds compressed: what the rest reads is a document that holds them plainly.
//!
//! Compressed buffer views (`meshopt`) and primitives (`draco`) are decoded when the file is opened, into a buffer of its own that
//! the plain document has in addition. Where the file has the plain form as well, as it may where it does not require the
//! extension, that is read instead.

mod draco;
mod meshopt;
mod plain;

use crate::document::Document;
use crate::error::Fault;
use plain::PlainDocument;
use serde_json::Value;

/// Decodes what a document holds by some extensions into a plain one; all of it if they are required.
type Decoder = fn(&Document<'_>, &mut PlainDocument, bool) -> Result<(), Fault>;

/// The plain document of one that may hold compressed meshes.
pub(crate) fn decompress(document: Document<'_>) -> Result<Document<'_>, Fault> {
    // Primitives may lie in compressed views.
    let kinds: [(&[&'static str], Decoder); 2] =
        [(&meshopt::EXTENSIONS, meshopt::decode), (&[draco::EXTENSION], draco::decode)];
    kinds.into_iter().try_fold(document, |document, (extensions, decode)| {
        let lists = |list: &str| {
            let names = document.root_value().get(list).and_then(Value::as_array).into_iter().flatten();
            names.filter_map(Value::as_str).any(|name| extensions.contains(&name))
        };
        let is_required = lists("extensionsRequired");
        if !is_required && !lists("extensionsUsed") {
            return Ok(document);
        }
        let root = document.root_value().clone();
        let mut plain = PlainDocument { root, bytes: Vec::new(), buffer: document.len("buffers") };
        decode(&document, &mut plain, is_required)?;
        if plain.bytes.is_empty() {
            Ok(document)
        } else {
            document.with_decoded_buffer(plain.root, plain.bytes, extensions)
        }
    })
}
