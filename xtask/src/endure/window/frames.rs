//! The window's own record of its frames (`FOCUS_BRUSH_FRAME_LOG`).

use std::path::Path;

/// A second in which the window drew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Second {
    /// Since the start, s.
    pub at: f64,
    /// The longest frame, ms.
    pub longest_ms: f64,
    /// Jobs at work at its end.
    pub jobs: usize,
}

/// All seconds that were recorded. The last line may still be being written.
pub fn read(file: &Path) -> Vec<Second> {
    let text = std::fs::read_to_string(file).unwrap_or_default();
    let complete = text.rfind('\n').map_or("", |end| &text[..end]);
    complete.lines().filter_map(parse).collect()
}

fn parse(line: &str) -> Option<Second> {
    let mut words = line.split_whitespace();
    let at = words.next()?.parse().ok()?;
    let longest_ms = words.nth(1)?.parse().ok()?;
    let jobs = words.next()?.parse().ok()?;
    Some(Second { at, longest_ms, jobs })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_read() {
        assert_eq!(parse("12.5 31 40.2 1"), Some(Second { at: 12.5, longest_ms: 40.2, jobs: 1 }));
        assert_eq!(parse("12.5 31"), None);
    }
}
