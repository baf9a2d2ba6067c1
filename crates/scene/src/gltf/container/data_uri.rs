//! Data embedded in the document: `data:` URIs (RFC 2397).

use crate::gltf::container::percent_encoding::percent_decoded;

/// The part after `data:`.
pub(crate) fn strip_data_scheme(uri: &str) -> Option<&str> {
    let (scheme, data) = uri.split_at_checked(5)?;
    scheme.eq_ignore_ascii_case("data:").then_some(data)
}

/// Decodes the part of a data URI after `data:`.
pub(crate) fn decode_data(data: &str) -> Option<Vec<u8>> {
    let (header, body) = data.split_once(',')?;
    let (bytes, true) = percent_decoded(body) else { return None };
    if header.rsplit(';').next().is_some_and(|last| last.eq_ignore_ascii_case("base64")) {
        decode_base64(&bytes)
    } else {
        Some(bytes.into_owned())
    }
}

/// RFC 4648 §4; padding may be missing, whitespace and other characters are errors.
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
        assert_eq!(
            strip_data_scheme("DATA:text/plain;base64,Zg==").and_then(decode_data),
            Some(b"f".to_vec())
        );
        assert_eq!(strip_data_scheme("data:,a%20b").and_then(decode_data), Some(b"a b".to_vec()));
        assert_eq!(strip_data_scheme("data:").and_then(decode_data), None);
        assert_eq!(strip_data_scheme("dat"), None);
    }
}
