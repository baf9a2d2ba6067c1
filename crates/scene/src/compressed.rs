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
use plain::Plain;
use serde_json::Value;

/// The extensions that are taken out.
const EXTENSIONS: [&str; 3] = [draco::EXTENSION, "EXT_meshopt_compression", "KHR_meshopt_compression"];

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
        if plain.bytes.is_empty() {
            Ok(document)
        } else {
            document.with(plain.root, plain.bytes, &EXTENSIONS)
        }
    })
}
