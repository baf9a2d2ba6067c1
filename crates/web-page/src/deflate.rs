//! Compression that browsers undo by themselves.

use crate::error::WebPageError;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// Bytes compressed by deflate, with zlib's head: `DecompressionStream("deflate")` reads them.
///
/// # Errors
/// [`WebPageError::Encoder`]: they cannot be compressed.
pub fn deflate(bytes: &[u8]) -> Result<Vec<u8>, WebPageError> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    written.map_err(|error| WebPageError::Encoder(error.to_string()))
}
