//! The JSON text of a file, read leniently.
//!
//! glTF requires UTF-8 without a byte order mark, and spaces as padding of a GLB chunk. Exporters also write a byte
//! order mark, pad chunks with NULs or with uninitialised memory, and write numbers that JSON does not have (NaN and
//! Infinity). All of that is accepted, with a warning.
//!
//! Before the text is parsed its structure is counted, because a parsed document can take a hundred times the memory
//! of its text.

use crate::error::Fault;
use crate::gltf::budget::Budget;
use serde_json::{Deserializer, Value};

/// Parses the value of a text; harmless defects are passed to `warn`. `is_glb`: it is a GLB chunk and so must be
/// JSON, whatever it starts with.
pub(crate) fn parse(
    bytes: &[u8],
    is_glb: bool,
    budget: &Budget,
    warn: &mut dyn FnMut(String),
) -> Result<Value, Fault> {
    if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") {
        return Err(Fault::NotGltf("its text is UTF-16 instead of UTF-8".into()));
    }
    let mut text = trim_leading_padding(bytes, warn);
    budget.take_memory(2 * parsed_size(text), "the parsed document")?;
    let is_json = is_glb || text.starts_with(b"{");
    let mut parsed = first_value(text);
    let repaired;
    if parsed.is_err() && is_json {
        let copy = 2 * text.len() as u64;
        budget.take_memory(copy, "the repaired JSON text")?;
        repaired = replace_non_finite_numbers(text);
        budget.release_memory(copy);
        if repaired != text {
            text = &repaired;
            parsed = first_value(text);
            warn(
                "the JSON text has NaN or Infinity, which JSON does not allow; they count as missing".into(),
            );
        }
    }
    match parsed {
        Ok((value, end)) => {
            warn_about_trailing_bytes(&text[end..], warn);
            Ok(value)
        }
        Err(error) if is_json => Err(Fault::NotGltf(format!("its JSON is invalid: {error}"))),
        Err(_) => Err(Fault::NotGltf("it is neither GLB nor JSON".into())),
    }
}

/// The text without leading padding.
fn trim_leading_padding<'a>(bytes: &'a [u8], warn: &mut dyn FnMut(String)) -> &'a [u8] {
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    if text.len() < bytes.len() {
        warn("the JSON text starts with a byte order mark".into());
    }
    let start = text.iter().position(|&byte| !is_padding(byte)).unwrap_or(text.len());
    if text[..start].iter().any(|byte| !byte.is_ascii_whitespace()) {
        warn("the JSON text has NULs or control characters in front of it".into());
    }
    &text[start..]
}

/// Whether a byte is padding: white space, NUL, control characters.
fn is_padding(byte: u8) -> bool {
    byte <= b' '
}

/// The first value in a text, and the offset of its end.
fn first_value(text: &[u8]) -> Result<(Value, usize), serde_json::Error> {
    let mut values = Deserializer::from_slice(text).into_iter::<Value>();
    match values.next() {
        Some(value) => Ok((value?, values.byte_offset())),
        None => Err(serde::de::Error::custom("it is empty")),
    }
}

/// Warns about bytes after the value, unless they are spaces.
fn warn_about_trailing_bytes(rest: &[u8], warn: &mut dyn FnMut(String)) {
    // The white space that JSON allows; other kinds are as invalid as NULs.
    let is_space = |byte: &u8| matches!(byte, b' ' | b'\t' | b'\n' | b'\r');
    if rest.iter().all(is_space) {
        return;
    }
    let count = rest.len();
    warn(match rest.iter().all(|&byte| is_padding(byte)) {
        true => format!("the JSON text is padded with {count} NULs or control characters instead of spaces"),
        false => {
            format!("the JSON text is followed by {count} bytes that are not part of it; they are ignored")
        }
    });
}

/// A copy of the text with `null` in place of every NaN and infinity as programming languages write them: `NaN`,
/// `-Infinity`, `inf`, `-nan(ind)`, `1.#QNAN`.
fn replace_non_finite_numbers(text: &[u8]) -> Vec<u8> {
    let is_word = |byte: u8| byte.is_ascii_alphanumeric() || b"+-.#()".contains(&byte);
    let (mut copy, mut at, mut in_string) = (Vec::with_capacity(text.len()), 0, false);
    while at < text.len() {
        let start = at;
        match text[at] {
            b'\\' if in_string => at += 2,
            b'"' => {
                in_string = !in_string;
                at += 1;
            }
            byte if !in_string && is_word(byte) => {
                at += text[at..].iter().take_while(|&&byte| is_word(byte)).count();
                if is_non_finite_number(&text[start..at]) {
                    copy.extend_from_slice(b"null");
                    continue;
                }
            }
            _ => at += 1,
        }
        at = at.min(text.len());
        copy.extend_from_slice(&text[start..at]);
    }
    copy
}

/// Whether a word denotes NaN or an infinity.
fn is_non_finite_number(word: &[u8]) -> bool {
    let word = word.to_ascii_lowercase();
    let word = word.strip_prefix(b"-").or(word.strip_prefix(b"+")).unwrap_or(&word);
    [&b"nan"[..], b"inf", b"1.#"].iter().any(|start| word.starts_with(start))
}

/// An upper bound of the bytes that the parsed document takes.
pub(crate) fn parsed_size(json: &[u8]) -> u64 {
    // A map allocates eleven entries of key and value with its first; an array element is one value, and arrays grow
    // by doubling; strings are copied.
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
    use crate::LoadOptions;
    use serde_json::json;

    /// The value and the warnings.
    fn read(bytes: &[u8], is_glb: bool) -> Result<(Value, Vec<String>), String> {
        let mut warnings = Vec::new();
        let budget = Budget::new(&LoadOptions::default());
        let before = budget.memory_left();
        let value = parse(bytes, is_glb, &budget, &mut |warning| warnings.push(warning));
        assert!(before - budget.memory_left() <= 2 * parsed_size(bytes), "the copy is given back");
        value.map(|value| (value, warnings)).map_err(|fault| fault.to_string())
    }

    #[test]
    fn structure_counts_outside_strings_only() {
        let text = br#"{"a":"{{{{[[[[,,,,\"{{"}"#;
        assert_eq!(parsed_size(text), 700 + text.len() as u64);
        assert_eq!(parsed_size(b"[1,2,3]"), 300 + 7);
    }

    #[test]
    fn spaces_are_the_only_filling_without_a_warning() {
        for filling in [&b""[..], b" ", b"   ", b"\n\t \r"] {
            assert_eq!(read(&[b"{}", filling].concat(), true), Ok((json!({}), vec![])), "{filling:?}");
        }
        for filling in
            [&b"\0"[..], b"\0\0\0", b" \0", b"\0 ", b"\x0c", b"\x1a", b"\xff\xff", b"\xcd", b"}", b"{"]
        {
            for is_glb in [true, false] {
                let (value, warnings) = read(&[b"{\"a\": 1}", filling].concat(), is_glb).unwrap();
                assert_eq!((value, warnings.len()), (json!({"a": 1}), 1), "{filling:?}: {warnings:?}");
            }
        }
    }

    #[test]
    fn leading_bytes_are_skipped() {
        assert_eq!(read(b" \n{}", false), Ok((json!({}), vec![])));
        for head in [&b"\xEF\xBB\xBF"[..], b"\0\0", b"\xEF\xBB\xBF \0"] {
            let (value, warnings) = read(&[head, b"{}"].concat(), false).unwrap();
            assert!(value == json!({}) && !warnings.is_empty(), "{head:?}: {warnings:?}");
        }
        assert!(read(b"\xFF\xFE{\0}\0", false).unwrap_err().contains("UTF-16"));
    }

    #[test]
    fn text_that_is_not_json_is_rejected() {
        for text in [&b"{"[..], b"{\"a\" 1}", b"{\"a\": nonsense}", b"{\"a\": NaN"] {
            assert!(read(text, false).unwrap_err().contains("invalid"), "{text:?}");
        }
        for text in [&b"\0\0\0"[..], b"  ", b"solid cube"] {
            assert!(read(text, false).unwrap_err().contains("neither GLB nor JSON"), "{text:?}");
            assert!(read(text, true).unwrap_err().contains("its JSON is invalid"), "{text:?}");
        }
    }

    #[test]
    fn numbers_that_json_lacks_become_null() {
        for number in
            ["NaN", "-NaN", "Infinity", "-Infinity", "inf", "nan", "-nan(ind)", "1.#QNAN", "-1.#INF"]
        {
            let text = format!(r#"{{"range": {number}, "name": "NaN \" Infinity", "list": [{number},1e5]}}"#);
            let (value, warnings) = read(text.as_bytes(), true).unwrap();
            let expected = json!({"range": null, "name": "NaN \" Infinity", "list": [null, 1e5]});
            assert_eq!((value, warnings.len()), (expected, 1), "{number}: {warnings:?}");
        }
    }
}
