//! The outer structure of a file: JSON text and, in a .glb, the binary chunk after it.
//!
//! The `gltf` crate's own splitter rejects truncated files, which are opened here as far as possible, and trusts the
//! length in the header; so the chunks are parsed here.

use crate::error::Fault;

/// The two parts of a file.
#[derive(Debug)]
pub(crate) struct Container<'a> {
    pub json: &'a [u8],
    pub chunk: Option<&'a [u8]>,
    pub is_glb: bool,
}

const GLB_MAGIC: &[u8] = b"glTF";
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BIN: u32 = 0x004E_4942;
const HEADER: usize = 12;

/// Only two chunks are used; a file of very many would just take time.
const MAX_CHUNKS: usize = 1000;

/// Splits the bytes of a .glb or .gltf file; harmless defects are passed to `warn`.
pub(crate) fn split_chunks<'a>(
    bytes: &'a [u8],
    warn: &mut dyn FnMut(String),
) -> Result<Container<'a>, Fault> {
    if bytes.is_empty() {
        return Err(Fault::NotGltf("it is empty".into()));
    }
    if bytes.starts_with(GLB_MAGIC) {
        return split_glb(bytes, warn);
    }
    Ok(Container { json: bytes, chunk: None, is_glb: false })
}

fn read_u32(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
}

fn split_glb<'a>(bytes: &'a [u8], warn: &mut dyn FnMut(String)) -> Result<Container<'a>, Fault> {
    let (Some(version), Some(declared)) = (read_u32(bytes, 4), read_u32(bytes, 8)) else {
        return Err(Fault::NotGltf("the GLB header is cut off".into()));
    };
    if version != 2 {
        return Err(Fault::NotGltf(format!("GLB version {version} instead of 2")));
    }
    let declared = declared as usize;
    if declared != bytes.len() {
        warn(format!("the GLB header declares {declared} bytes, the file has {}", bytes.len()));
    }
    let (mut json, mut chunk, mut at, mut count) = (None, None, HEADER, 0);
    while at < bytes.len() {
        let header = read_u32(bytes, at).zip(read_u32(bytes, at + 4));
        let is_padding = header.is_none_or(|(length, kind)| length == 0 && kind == 0);
        let is_past_end = at >= declared && !is_chunk_header(bytes, at);
        count += 1;
        let Some((length, kind)) = header.filter(|_| !is_padding && !is_past_end && count <= MAX_CHUNKS)
        else {
            warn(format!("the {} bytes after the last GLB chunk are ignored", bytes.len() - at));
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
            CHUNK_JSON if json.is_none() => {
                json = Some(body);
                if at > HEADER {
                    warn("the first GLB chunk is not JSON, a later one is".into());
                }
            }
            CHUNK_BIN if chunk.is_none() => chunk = Some(body),
            CHUNK_JSON | CHUNK_BIN => warn(format!("a second GLB chunk of type {kind:#010x} is ignored")),
            _ => warn(format!("a GLB chunk of unknown type {kind:#010x} is ignored")),
        }
        at = next_chunk(bytes, start.saturating_add(length));
    }
    match json {
        Some(json) => Ok(Container { json, chunk, is_glb: true }),
        None => Err(Fault::NotGltf("the GLB file has no JSON chunk".into())),
    }
}

fn is_chunk_header(bytes: &[u8], at: usize) -> bool {
    matches!(read_u32(bytes, at.saturating_add(4)), Some(CHUNK_JSON | CHUNK_BIN))
}

/// Start of the chunk after one that by its length ends at `end`. Some writers pad a chunk without counting that in
/// its length, or count padding that they did not write, so the next chunk may be up to three bytes off.
fn next_chunk(bytes: &[u8], end: usize) -> usize {
    let near = [0, 1, 2, 3, -1, -2, -3].map(|offset| end.saturating_add_signed(offset));
    near.into_iter().find(|&at| is_chunk_header(bytes, at)).unwrap_or(end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_truncated_chunk_is_read_with_a_warning() {
        let mut bytes = b"glTF\x02\0\0\0\x00\x01\0\0\x02\0\0\0JSON{}".to_vec();
        bytes.extend(b"\xFF\xFF\xFF\xFFBIN\0abc");
        let mut warnings = Vec::new();
        let container = split_chunks(&bytes, &mut |w| warnings.push(w)).unwrap();
        assert_eq!((container.json, container.chunk), (&b"{}"[..], Some(&b"abc"[..])));
        assert_eq!(warnings.len(), 4, "{warnings:?}");
    }

    /// A GLB whose header says what is there, and that many bytes more.
    fn glb(chunks: &[(u32, &[u8], &[u8])], more: i32) -> Vec<u8> {
        let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        for (length, kind, body) in chunks {
            bytes.extend(length.to_le_bytes().iter().chain(*kind).chain(*body));
        }
        let length = (bytes.len() as i32 + more) as u32;
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        bytes
    }

    fn parts(bytes: &[u8]) -> (&[u8], Option<&[u8]>, Vec<String>) {
        let mut warnings = Vec::new();
        let container = split_chunks(bytes, &mut |w| warnings.push(w)).unwrap();
        (container.json, container.chunk, warnings)
    }

    #[test]
    fn a_sound_file_has_no_warning() {
        let bytes = glb(&[(4, b"JSON", b"{}  "), (4, b"BIN\0", b"abcd")], 0);
        assert_eq!(parts(&bytes), (&b"{}  "[..], Some(&b"abcd"[..]), vec![]));
    }

    #[test]
    fn a_chunk_that_is_filled_up_may_count_that_or_not() {
        // Filled up by two bytes that its length leaves out; by none that it counts; by one too many.
        for (length, body) in [(2, &b"{}  "[..]), (2, b"{}\0\0"), (4, b"{}"), (4, b"{}   "), (3, b"{}  ")] {
            let bytes = glb(&[(length, b"JSON", body), (4, b"BIN\0", b"abcd")], 0);
            let (json, chunk, _) = parts(&bytes);
            assert!(
                json.starts_with(b"{}") && chunk == Some(&b"abcd"[..]),
                "{length} {body:?}: {json:?} {chunk:?}"
            );
        }
    }

    #[test]
    fn the_length_in_the_header_does_not_matter() {
        for more in [-40, -8, -4, 1, 1 << 20] {
            let bytes = glb(&[(4, b"JSON", b"{}  "), (4, b"BIN\0", b"abcd")], more);
            let (json, chunk, warnings) = parts(&bytes);
            assert_eq!((json, chunk, warnings.len()), (&b"{}  "[..], Some(&b"abcd"[..]), 1), "{warnings:?}");
        }
    }

    #[test]
    fn what_follows_the_last_chunk_is_ignored() {
        for rest in [&b"\0"[..], b"\0\0\0\0", b"any text at all, longer than a header", &[0; 100_000]] {
            // Counted in the header or not.
            for more in [0, -(rest.len() as i32)] {
                let mut bytes = glb(&[(4, b"JSON", b"{}  "), (4, b"BIN\0", b"abcd")], 0);
                bytes.extend(rest);
                let length = (bytes.len() as i32 + more) as u32;
                bytes[8..12].copy_from_slice(&length.to_le_bytes());
                let (json, chunk, warnings) = parts(&bytes);
                assert_eq!((json, chunk), (&b"{}  "[..], Some(&b"abcd"[..])));
                assert!((1..5).contains(&warnings.len()), "{warnings:?}");
            }
        }
    }

    #[test]
    fn other_chunks_are_ignored_at_any_position() {
        let (json, bin, other) = (
            (4, &b"JSON"[..], &b"{}  "[..]),
            (4, &b"BIN\0"[..], &b"abcd"[..]),
            (3, &b"xtra"[..], &b"abc"[..]),
        );
        for order in [[json, bin, other], [json, other, bin], [other, json, bin], [bin, json, other]] {
            let bytes = glb(&order, 0);
            let (json, chunk, warnings) = parts(&bytes);
            assert_eq!((json, chunk), (&b"{}  "[..], Some(&b"abcd"[..])), "{order:?}");
            assert!(!warnings.is_empty());
        }
        let many = [vec![json], vec![(0, &b"xtra"[..], &b""[..]); 100_000]].concat();
        assert!(parts(&glb(&many, 0)).2.len() <= MAX_CHUNKS + 1);
        assert!(
            split_chunks(&glb(&[bin], 0), &mut |_| {}).unwrap_err().to_string().contains("no JSON chunk")
        );
    }
}
