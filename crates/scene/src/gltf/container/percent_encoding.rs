//! Percent-encoding (RFC 3986 §2.1).

use std::borrow::Cow;

/// Decodes every `%XX`. A `%` without two hexadecimal digits after it stays as it is; the flag is whether there was
/// none.
pub(crate) fn percent_decoded(text: &str) -> (Cow<'_, [u8]>, bool) {
    if !text.contains('%') {
        return (Cow::Borrowed(text.as_bytes()), true);
    }
    let digit = |byte: Option<&u8>| byte.and_then(|&byte| char::from(byte).to_digit(16));
    let (mut bytes, mut is_sound, mut rest) = (Vec::with_capacity(text.len()), true, text.as_bytes());
    while let [first, tail @ ..] = rest {
        rest = tail;
        match (first, digit(rest.first()), digit(rest.get(1))) {
            (b'%', Some(high), Some(low)) => {
                bytes.push((high * 16 + low) as u8);
                rest = &rest[2..];
            }
            (byte, ..) => {
                bytes.push(*byte);
                is_sound &= *byte != b'%';
            }
        }
    }
    (Cow::Owned(bytes), is_sound)
}

#[cfg(test)]
mod tests {
    use super::percent_decoded;

    #[test]
    fn malformed_escapes_stay_as_they_are() {
        for (text, decoded, is_sound) in [
            ("a b", &b"a b"[..], true),
            ("a%20b", b"a b", true),
            ("%e9%2F", b"\xe9/", true),
            ("10%", b"10%", false),
            ("10%.bin", b"10%.bin", false),
            ("%zz%4", b"%zz%4", false),
            ("%%20", b"% ", false),
            ("%2%20", b"%2 ", false),
            ("é%", "é%".as_bytes(), false),
        ] {
            let (bytes, sound) = percent_decoded(text);
            assert_eq!((&bytes[..], sound), (decoded, is_sound), "{text}");
        }
    }
}
