//! Text in HTML and in scripts: whatever it contains, it stays text.

use serde::Serialize;
use serde_json::ser::{CharEscape, Formatter, Serializer};
use std::io;

/// `text` for an element or a quoted attribute of HTML.
pub fn escape_html(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            // No character of HTML: a browser would drop or replace it.
            '\0' => escaped.push('\u{FFFD}'),
            other => escaped.push(other),
        }
    }
    escaped
}

/// JSON whose strings hold control characters as they are, which JavaScript allows; but not those that a reader of HTML changes.
struct RawControls;

impl Formatter for RawControls {
    fn write_char_escape<W: io::Write + ?Sized>(&mut self, to: &mut W, escape: CharEscape) -> io::Result<()> {
        match escape {
            CharEscape::Quote => to.write_all(b"\\\""),
            CharEscape::ReverseSolidus | CharEscape::Solidus => to.write_all(b"\\\\"),
            CharEscape::LineFeed => to.write_all(b"\\n"),
            CharEscape::CarriageReturn => to.write_all(b"\\r"),
            CharEscape::Backspace => to.write_all(b"\x08"),
            CharEscape::FormFeed => to.write_all(b"\x0c"),
            CharEscape::Tab => to.write_all(b"\t"),
            CharEscape::AsciiControl(0) => to.write_all(b"\\u0000"),
            CharEscape::AsciiControl(control) => to.write_all(&[control]),
        }
    }
}

/// `value` as an expression of JavaScript that may stand in an inline script: JSON without `<`, which could end the script or begin a
/// comment, and without what old browsers take for ends of lines. Control characters but NUL and ends of lines are not escaped.
///
/// # Errors
/// The value has no form in JSON.
pub fn script_value(value: &impl Serialize) -> Result<String, serde_json::Error> {
    let mut json = Vec::new();
    value.serialize(&mut Serializer::with_formatter(&mut json, RawControls))?;
    let json = String::from_utf8(json).map_err(serde::ser::Error::custom)?;
    // Each of them only occurs inside strings.
    let is_unsafe = |c: char| matches!(c, '<' | '\u{2028}' | '\u{2029}');
    let mut script = String::with_capacity(json.len());
    let mut rest = json.as_str();
    while let Some(at) = rest.find(is_unsafe) {
        let (safe, from_unsafe) = rest.split_at(at);
        let mut characters = from_unsafe.chars();
        let code = characters.next().map_or(0, u32::from);
        script.push_str(safe);
        script.push_str(&format!("\\u{code:04x}"));
        rest = characters.as_str();
    }
    script.push_str(rest);
    Ok(script)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOSTILE: &str = "</script><script>alert(1)</script> <!-- \"it's\" & 🦊 \u{2028} {{title}}";

    #[test]
    fn html_has_no_markup_left() {
        let escaped = escape_html(HOSTILE);
        assert!(!escaped.contains(['<', '>', '"', '\'']), "{escaped}");
        assert!(escaped.contains("🦊") && escaped.contains("&lt;/script&gt;"));
        assert_eq!(escape_html("a\0b"), "a\u{FFFD}b");
    }

    #[test]
    fn what_html_changes_is_escaped_and_nothing_else() {
        let controls: String = (0..32).filter_map(char::from_u32).collect();
        let script = script_value(&controls).unwrap();
        assert!(
            !script.contains(['\0', '\n', '\r']) && script.contains("\t\\n\x0b\x0c\\r\x0e"),
            "{script:?}"
        );
    }

    #[test]
    fn a_script_gets_the_same_value() {
        let script = script_value(&HOSTILE).unwrap();
        assert!(!script.contains(['<', '\u{2028}']), "{script}");
        assert_eq!(serde_json::from_str::<String>(&script).unwrap(), HOSTILE);
    }
}
