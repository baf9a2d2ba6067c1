//! The files and embedded data that a document refers to.
//!
//! A reference is a data URI or a relative path inside the scene's folder. Everything else (absolute paths,
//! `..`, schemes, links that lead outside) is refused: opening a scene must not read the rest of the disk.

use crate::document::Document;
use crate::error::Fault;
use gltf::buffer::Source;
use std::borrow::Cow;
use std::io::Read;
use std::path::{Path, PathBuf};

impl<'a> Document<'a> {
    /// The bytes of the `uri` of the buffer or image at `owner`.
    pub fn resource(&self, owner: &str, uri: &str) -> Result<Vec<u8>, Fault> {
        let refuse = |what: &str| Fault::Resource {
            place: format!("{owner}/uri"),
            uri: shortened(uri),
            what: what.into(),
        };
        if let Some(data) = data_uri(uri) {
            self.budget.memory(data.len() as u64, owner)?;
            return decode_data(data).ok_or_else(|| refuse("is not valid data (export the scene again)"));
        }
        let path = inner_path(uri).map_err(refuse)?;
        let path = resolve(&self.folder, &path).map_err(|what| refuse(&what))?;
        let size = path.metadata().map_err(|error| refuse(&unreadable(&error)))?.len();
        self.budget.memory(size, &shortened(uri))?;
        let mut bytes = Vec::with_capacity(size as usize);
        // No more than was accounted for, even if the file is growing.
        let read = std::fs::File::open(&path).and_then(|file| file.take(size).read_to_end(&mut bytes));
        read.map_err(|error| refuse(&unreadable(&error)))?;
        Ok(bytes)
    }

    /// The bytes of a buffer, as far as they are declared and there. They are read once.
    pub fn buffer(&self, index: usize, place: &str) -> Result<&[u8], Fault> {
        let own = self.entry("buffers", index, place)?;
        self.sound_below(&own)?;
        let buffer = self.typed().buffers().nth(index);
        let Some((declared, source)) = buffer.map(|buffer| (buffer.length(), buffer.source())) else {
            return Err(Fault::NoData { place: own });
        };
        let bytes: &[u8] = match (source, self.chunk) {
            (Source::Uri(uri), _) => {
                let cell = &self.buffers[index];
                if cell.get().is_none() {
                    let bytes = self.resource(&own, uri)?;
                    cell.get_or_init(|| bytes);
                }
                cell.get().map_or(&[], Vec::as_slice)
            }
            (Source::Bin, Some(chunk)) if index == 0 => chunk,
            (Source::Bin, _) => return Err(Fault::NoData { place: own }),
        };
        if bytes.len() < declared {
            self.warn(format!("{own}/byteLength: declares {declared} bytes, but there are {}", bytes.len()));
        }
        Ok(&bytes[..bytes.len().min(declared)])
    }

    /// The bytes of a buffer view and its stride, if it declares one.
    pub fn buffer_view(&self, index: usize, place: &str) -> Result<(&[u8], Option<usize>), Fault> {
        let own = self.entry("bufferViews", index, place)?;
        self.sound_below(&own)?;
        let Some(view) = self.typed().views().nth(index) else {
            return Err(Fault::NoData { place: own });
        };
        let buffer = view.buffer().index();
        let bytes = self.buffer(buffer, &format!("{own}/buffer"))?;
        let (offset, length) = (view.offset(), view.length());
        let Some(end) = offset.checked_add(length).filter(|&end| end <= bytes.len()) else {
            return Err(Fault::Malformed {
                place: own,
                what: format!(
                    "bytes {offset} + {length} do not fit buffer {buffer} of {} bytes",
                    bytes.len()
                ),
            });
        };
        Ok((&bytes[offset..end], view.stride()))
    }
}

fn unreadable(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "is missing (put it back beside the scene file)".into(),
        _ => format!("cannot be read: {error} (check the file)"),
    }
}

/// A URI for a message: without the megabytes of a data URI.
fn shortened(uri: &str) -> String {
    let mut text: String = uri.chars().take(60).map(|c| if c.is_control() { '?' } else { c }).collect();
    if uri.chars().nth(60).is_some() {
        text.push('…');
    }
    text
}

/// What follows `data:`.
pub(crate) fn data_uri(uri: &str) -> Option<&str> {
    let (scheme, data) = uri.split_at_checked(5)?;
    scheme.eq_ignore_ascii_case("data:").then_some(data)
}

/// Decodes the part of a data URI behind `data:`.
pub(crate) fn decode_data(data: &str) -> Option<Vec<u8>> {
    let (header, body) = data.split_once(',')?;
    if header.rsplit(';').next().is_some_and(|last| last.eq_ignore_ascii_case("base64")) {
        decode_base64(&percent_decoded(body)?)
    } else {
        Some(percent_decoded(body)?.into_owned())
    }
}

/// RFC 4648 §4; padding may be missing, whitespace and other characters may not occur.
fn decode_base64(text: &[u8]) -> Option<Vec<u8>> {
    let text = text.strip_suffix(b"==").or_else(|| text.strip_suffix(b"=")).unwrap_or(text);
    if text.len() % 4 == 1 {
        return None;
    }
    let digit = |byte: u8| match byte {
        b'A'..=b'Z' => Some(byte - b'A'),
        b'a'..=b'z' => Some(byte - b'a' + 26),
        b'0'..=b'9' => Some(byte - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let mut bytes = Vec::with_capacity(text.len() * 3 / 4);
    for group in text.chunks(4) {
        let mut bits = 0u32;
        for (i, &byte) in group.iter().enumerate() {
            bits |= u32::from(digit(byte)?) << (18 - 6 * i);
        }
        bytes.extend_from_slice(&bits.to_be_bytes()[1..group.len()]);
    }
    Some(bytes)
}

/// Undoes %XX.
fn percent_decoded(text: &str) -> Option<Cow<'_, [u8]>> {
    if !text.contains('%') {
        return Some(Cow::Borrowed(text.as_bytes()));
    }
    let (mut bytes, mut rest) = (Vec::with_capacity(text.len()), text.as_bytes());
    while let [first, tail @ ..] = rest {
        rest = tail;
        if *first != b'%' {
            bytes.push(*first);
            continue;
        }
        let (high, low) = (char::from(*rest.first()?).to_digit(16)?, char::from(*rest.get(1)?).to_digit(16)?);
        bytes.push((high * 16 + low) as u8);
        rest = &rest[2..];
    }
    Some(Cow::Owned(bytes))
}

/// The relative path that a URI means, or what is wrong with it.
fn inner_path(uri: &str) -> Result<PathBuf, &'static str> {
    const OUTSIDE: &str = "leads outside the scene's folder (keep the file beside the scene and refer to it by a relative path)";
    let bytes = percent_decoded(uri).ok_or("is not a valid URI (export the scene again)")?;
    let text = std::str::from_utf8(&bytes).map_err(|_| "is not a valid URI (export the scene again)")?;
    if text.is_empty() || text.contains('\0') {
        return Err("is not a file name (export the scene again)");
    }
    let mut path = PathBuf::new();
    // Some exporters on Windows write backslashes; a colon is a scheme or a drive.
    for (i, part) in text.split(['/', '\\']).enumerate() {
        match part {
            "" if i == 0 => return Err(OUTSIDE),
            "" | "." => {}
            ".." => return Err(OUTSIDE),
            part if part.contains(':') => return Err(OUTSIDE),
            part => path.push(part),
        }
    }
    Ok(path)
}

/// The regular file at `path` inside `folder`, links followed.
fn resolve(folder: &Path, path: &Path) -> Result<PathBuf, String> {
    let real = folder.join(path).canonicalize().map_err(|error| unreadable(&error))?;
    if !real.starts_with(folder) {
        return Err("is a link that leads outside the scene's folder (copy the file there)".into());
    }
    if !real.is_file() {
        return Err("is not a file (put the file back beside the scene file)".into());
    }
    Ok(real)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_by_the_book() {
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg", "foob"),
            ("Zm9vYmE=", "fooba"),
        ] {
            assert_eq!(decode_base64(text.as_bytes()).unwrap(), bytes.as_bytes());
        }
        for text in ["Z", "Zg=v", "Zm 9v", "Zm9v!"] {
            assert_eq!(decode_base64(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn data_uris() {
        assert_eq!(data_uri("DATA:text/plain;base64,Zg==").and_then(decode_data), Some(b"f".to_vec()));
        assert_eq!(data_uri("data:,a%20b").and_then(decode_data), Some(b"a b".to_vec()));
        assert_eq!(data_uri("data:").and_then(decode_data), None);
        assert_eq!(data_uri("dat"), None);
    }

    #[test]
    fn only_inner_paths() {
        assert_eq!(inner_path("a%20b/c.png"), Ok("a b/c.png".into()));
        assert_eq!(inner_path("./textures\\c.png"), Ok("textures/c.png".into()));
        let outside = [
            "../a",
            "a/../../b",
            "/etc/passwd",
            "\\\\host\\share",
            "file:///etc/passwd",
            "http://x/y",
            "C:\\x",
        ];
        for uri in outside.into_iter().chain(["%2e%2e/a", "%2Fetc/passwd", "a/..%5Cb", "", "%00", "%zz", "%"])
        {
            assert!(inner_path(uri).is_err(), "{uri}");
        }
    }
}
