//! Compressed buffer views: EXT_meshopt_compression, and KHR_meshopt_compression, which adds a filter for colours.

use super::plain_document::{PlainDocument, index_or_zero};
use crate::error::Fault;
use crate::gltf::document::Document;
use meshopt::ffi;
use serde_json::{Map, Value, json};

pub(super) const EXTENSIONS: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// Replaces each compressed view by its decoded bytes, unless it has an uncompressed form and the extension is not
/// required.
pub(super) fn decode(
    document: &Document<'_>,
    plain: &mut PlainDocument,
    is_required: bool,
) -> Result<(), Fault> {
    for index in 0..document.len("bufferViews") {
        let view = document.item("bufferViews", index, "")?;
        let compressed = EXTENSIONS.iter().find_map(|name| Some((*name, view.get("extensions")?.get(name)?)));
        let Some((name, compressed)) = compressed else { continue };
        if !is_required && !is_fallback(document, view.index("buffer").ok().flatten()) {
            continue;
        }
        let place = format!("/bufferViews/{index}/extensions/{name}");
        let Some(compressed) = compressed.as_object() else {
            return Err(Fault::Malformed { place, what: "is not an object".into() });
        };
        let bytes = decode_view(document, compressed, &place)?;
        let start = plain.append(&bytes);
        document.budget.release_memory(bytes.len() as u64);
        let place = format!("/bufferViews/{index}");
        let buffer = plain.buffer;
        if let Some(Value::Object(view)) = plain.root.pointer_mut(&place) {
            view.insert("buffer".into(), json!(buffer));
            view.insert("byteOffset".into(), json!(start));
            view.insert("byteLength".into(), json!(bytes.len()));
        }
        EXTENSIONS.iter().for_each(|name| plain.remove_extension(&place, name));
    }
    Ok(())
}

/// Whether a buffer is only a placeholder for the decoded views.
fn is_fallback(document: &Document<'_>, buffer: Option<usize>) -> bool {
    let buffer =
        buffer.and_then(|buffer| document.item("buffers", buffer, "").ok().map(|item| (buffer, item)));
    buffer.is_none_or(|(index, buffer)| {
        buffer.get("uri").is_none() && !(index == 0 && document.chunk.is_some())
            || EXTENSIONS.iter().any(|name| {
                let flag =
                    buffer.get("extensions").and_then(|extensions| extensions.get(name)?.get("fallback"));
                flag == Some(&Value::Bool(true))
            })
    })
}

/// Decodes a compressed view.
#[allow(unsafe_code, reason = "meshoptimizer's decoders are C++; sizes are checked before each call")]
fn decode_view(document: &Document<'_>, view: &Map<String, Value>, place: &str) -> Result<Vec<u8>, Fault> {
    let malformed = |key: &str, what: String| Fault::Malformed { place: format!("{place}/{key}"), what };
    let text = |key: &str, default: &'static str| view.get(key).map_or(Some(default), Value::as_str);
    let size = |key: &str| index_or_zero(view, key, place);
    let (count, stride) = (size("count")?, size("byteStride")?);
    let mode = text("mode", "").unwrap_or_default();
    let is_valid_stride = match mode {
        "ATTRIBUTES" => stride.is_multiple_of(4) && (4..=256).contains(&stride),
        "TRIANGLES" | "INDICES" => [2, 4].contains(&stride),
        _ => return Err(malformed("mode", format!("is {mode:?}, not ATTRIBUTES, TRIANGLES or INDICES"))),
    };
    if !is_valid_stride {
        return Err(malformed("byteStride", format!("{stride} is not a valid stride for {mode}")));
    }
    if mode == "TRIANGLES" && !count.is_multiple_of(3) {
        return Err(malformed("count", format!("{count} is not a multiple of 3")));
    }
    let filter = text("filter", "NONE").unwrap_or_default();
    let fits = match filter {
        "NONE" => true,
        "OCTAHEDRAL" | "COLOR" => mode == "ATTRIBUTES" && [4, 8].contains(&stride),
        "QUATERNION" => mode == "ATTRIBUTES" && stride == 8,
        "EXPONENTIAL" => mode == "ATTRIBUTES",
        _ => return Err(malformed("filter", format!("{filter:?} is unknown"))),
    };
    if !fits {
        return Err(malformed("filter", format!("{filter} does not fit {mode} of {stride} bytes")));
    }
    let buffer = document.buffer(size("buffer")?, &format!("{place}/buffer"))?;
    let (offset, length) = (size("byteOffset")?, size("byteLength")?);
    let encoded = offset.checked_add(length).and_then(|end| buffer.get(offset..end));
    let Some(encoded) = encoded else {
        let what = format!("bytes {offset} + {length} do not fit its buffer of {} bytes", buffer.len());
        return Err(malformed("byteLength", what));
    };
    // Do not allocate impossible sizes: 256 equal bytes of a column take two bits at least, a triangle and an index a
    // byte.
    let max_size = match mode {
        "ATTRIBUTES" => length.saturating_mul(1024),
        "TRIANGLES" => length.saturating_mul(3 * stride),
        _ => length.saturating_mul(stride),
    };
    let Some(decoded_size) = count.checked_mul(stride).filter(|&decoded_size| decoded_size <= max_size)
    else {
        return Err(malformed("count", format!("{count} are more than {length} bytes can hold")));
    };
    document.budget.take_memory(decoded_size as u64, place)?;
    document.budget.take_work(decoded_size as u64 / 4, place)?;
    let mut bytes = vec![0; decoded_size];
    let (to, from) = (bytes.as_mut_ptr(), encoded.as_ptr());
    // SAFETY: `bytes` holds `count` elements of `stride` bytes, and `encoded` so many bytes; strides and counts are such as these
    // functions ask for (checked above), and they stay within both for any input.
    let status = unsafe {
        match mode {
            "ATTRIBUTES" => ffi::meshopt_decodeVertexBuffer(to.cast(), count, stride, from, length),
            "TRIANGLES" => ffi::meshopt_decodeIndexBuffer(to.cast(), count, stride, from, length),
            _ => ffi::meshopt_decodeIndexSequence(to.cast(), count, stride, from, length),
        }
    };
    if status != 0 {
        return Err(malformed("byteOffset", "its bytes cannot be decoded (export the scene again)".into()));
    }
    // SAFETY: as above; these change elements in place.
    unsafe {
        match filter {
            "OCTAHEDRAL" => ffi::meshopt_decodeFilterOct(to.cast(), count, stride),
            "QUATERNION" => ffi::meshopt_decodeFilterQuat(to.cast(), count, stride),
            "EXPONENTIAL" => ffi::meshopt_decodeFilterExp(to.cast(), count, stride),
            "COLOR" => ffi::meshopt_decodeFilterColor(to.cast(), count, stride),
            _ => {}
        }
    }
    Ok(bytes)
}
