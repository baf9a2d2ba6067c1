//! The outer shell of a file: JSON text and, in a .glb, the binary chunk behind it.
//!
//! The `gltf` crate's own splitter refuses files that are cut short, which open here as far as they go, and trusts
//! the length in the header; so the chunks are taken apart here.
//!
//! Before the JSON is parsed its structure is counted, because a parsed document can take a hundred times
//! the memory of its text.

use crate::error::Fault;

/// The two halves of a file.
pub(crate) struct Container<'a> {
    pub json: &'a [u8],
    pub chunk: Option<&'a [u8]>,
    pub is_glb: bool,
}

const GLB_MAGIC: &[u8] = b"glTF";
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BIN: u32 = 0x004E_4942;
const HEADER: usize = 12;

/// Splits the bytes of a .glb or .gltf file; harmless flaws go to `warn`.
pub(crate) fn split<'a>(bytes: &'a [u8], warn: &mut dyn FnMut(String)) -> Result<Container<'a>, Fault> {
    if bytes.is_empty() {
        return Err(Fault::NotGltf("it is empty".into()));
    }
    let mut container = if bytes.starts_with(GLB_MAGIC) {
        split_glb(bytes, warn)?
    } else {
        Container { json: bytes, chunk: None, is_glb: false }
    };
    if let Some(rest) = container.json.strip_prefix(b"\xEF\xBB\xBF") {
        warn("the JSON text starts with a byte order mark".into());
        container.json = rest;
    }
    Ok(container)
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

fn split_glb<'a>(bytes: &'a [u8], warn: &mut dyn FnMut(String)) -> Result<Container<'a>, Fault> {
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err(Fault::NotGltf("the GLB header is cut off".into()));
    };
    if version != 2 {
        return Err(Fault::NotGltf(format!("GLB version {version} instead of 2")));
    }
    if length as usize != bytes.len() {
        warn(format!("the GLB header declares {length} bytes, the file has {}", bytes.len()));
    }
    let mut container = Container { json: &[], chunk: None, is_glb: true };
    let (mut at, mut first) = (HEADER, true);
    while at < bytes.len() {
        let (Some(length), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) else {
            if first {
                return Err(Fault::NotGltf("the header of the first GLB chunk is cut off".into()));
            }
            warn("the last GLB chunk header is cut off".into());
            break;
        };
        let (length, start) = (length as usize, at + 8);
        let body = &bytes[start..bytes.len().min(start.saturating_add(length))];
        if body.len() < length {
            warn(format!("a GLB chunk declares {length} bytes, the file holds {} of them", body.len()));
        }
        if length % 4 != 0 {
            warn(format!("the length {length} of a GLB chunk is not a multiple of 4"));
        }
        match kind {
            CHUNK_JSON if first => container.json = body,
            _ if first => {
                return Err(Fault::NotGltf(format!("the first GLB chunk is of type {kind:#010x}, not JSON")));
            }
            CHUNK_BIN if container.chunk.is_none() => container.chunk = Some(body),
            CHUNK_JSON | CHUNK_BIN => warn(format!("a second GLB chunk of type {kind:#010x} is ignored")),
            _ => warn(format!("a GLB chunk of unknown type {kind:#010x} is ignored")),
        }
        first = false;
        at = start.saturating_add(length);
    }
    if first {
        return Err(Fault::NotGltf("the GLB file ends after its header".into()));
    }
    Ok(container)
}

/// An upper estimate of the bytes that the parsed document takes.
pub(crate) fn parsed_size(json: &[u8]) -> u64 {
    // A map allocates room for eleven entries of key and value with its first; an element of an array is one
    // value, the array grown by doubling; strings are copied.
    const MAP: u64 = 700;
    const ENTRY: u64 = 100;
    let (mut size, mut in_string, mut escaped) = (json.len() as u64, false, false);
    for &byte in json {
        if in_string {
            match byte {
                _ if escaped => escaped = false,
                b'\\' => escaped = true,
                b'"' => in_string = false,
                _ => {}
            }
        } else {
            match byte {
                b'"' => in_string = true,
                b'{' => size += MAP,
                b'[' | b',' => size += ENTRY,
                _ => {}
            }
        }
    }
    size
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structure_counts_outside_strings_only() {
        let text = br#"{"a":"{{{{[[[[,,,,\"{{"}"#;
        assert_eq!(parsed_size(text), 700 + text.len() as u64);
        assert_eq!(parsed_size(b"[1,2,3]"), 300 + 7);
    }

    #[test]
    fn a_cut_chunk_is_kept_with_a_warning() {
        let mut bytes = b"glTF\x02\0\0\0\x00\x01\0\0\x02\0\0\0JSON{}".to_vec();
        bytes.extend(b"\xFF\xFF\xFF\xFFBIN\0abc");
        let mut warnings = Vec::new();
        let container = split(&bytes, &mut |w| warnings.push(w)).unwrap();
        assert_eq!((container.json, container.chunk), (&b"{}"[..], Some(&b"abc"[..])));
        assert_eq!(warnings.len(), 4, "{warnings:?}");
    }
}
