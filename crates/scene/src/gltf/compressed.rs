//! Compressed meshes: they are replaced by uncompressed ones before the rest of the document is read.
//!
//! Compressed buffer views (`meshopt`) and primitives (`draco`) are decoded when the file is opened, into an
//! additional buffer of the uncompressed document. If the file has the uncompressed form as well, as it may if it
//! does not require the extension, that is read instead.

mod draco;
mod meshopt;
mod plain_document;

use crate::error::Fault;
use crate::gltf::document::Document;
use plain_document::PlainDocument;
use serde_json::Value;

/// Decodes what a document compresses by some extensions into an uncompressed one; the flag tells whether they are
/// required.
type Decoder = fn(&Document<'_>, &mut PlainDocument, bool) -> Result<(), Fault>;

/// The uncompressed form of a document that may contain compressed meshes.
pub(crate) fn decompress(document: Document<'_>) -> Result<Document<'_>, Fault> {
    // Primitives may lie in compressed views, so views come first.
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
