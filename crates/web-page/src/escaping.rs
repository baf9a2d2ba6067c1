//! Text in HTML and in scripts: whatever it contains, it stays text.

use serde::Serialize;

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

/// `value` as an expression of JavaScript that may stand in an inline script: JSON without `<`, which could end the script or begin a
/// comment, and without what old browsers take for ends of lines.
///
/// # Errors
/// The value has no form in JSON.
pub fn script_value(value: &impl Serialize) -> Result<String, serde_json::Error> {
    let json = serde_json::to_string(value)?;
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
    fn a_script_gets_the_same_value() {
        let script = script_value(&HOSTILE).unwrap();
        assert!(!script.contains(['<', '\u{2028}']), "{script}");
        assert_eq!(serde_json::from_str::<String>(&script).unwrap(), HOSTILE);
    }
}
