//! The table of contents, `docs/SUMMARY.md`: parts, pages, and pages below pages.

/// An entry of the table of contents.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chapter {
    /// Its title.
    pub title: String,
    /// Its page below `docs`; none for the title of a part.
    pub path: Option<String>,
    /// How far it is indented: 0 for a part or a page of the first level.
    pub level: usize,
}

/// The entries of a table of contents, in order.
pub fn parse(text: &str) -> Vec<Chapter> {
    text.lines().filter_map(chapter).collect()
}

/// `# Part`, `[Title](path)` or `- [Title](path)`, indented by two spaces a level.
fn chapter(line: &str) -> Option<Chapter> {
    let trimmed = line.trim_start();
    if let Some(title) = trimmed.strip_prefix("# ") {
        return Some(Chapter { title: title.into(), path: None, level: 0 });
    }
    let level = (line.len() - trimmed.len()) / 2;
    let link = trimmed.strip_prefix("- ").unwrap_or(trimmed).strip_prefix('[')?;
    let (title, path) = link.strip_suffix(')')?.split_once("](")?;
    Some(Chapter { title: title.into(), path: Some(path.into()), level })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_pages_are_read_in_their_order() {
        let chapters =
            parse("# Using it\n\n[What](a.md)\n- [One](guide/one.md)\n  - [Two](two.md)\n\ntext\n");
        let entry = |title: &str, path: Option<&str>, level| Chapter {
            title: title.into(),
            path: path.map(Into::into),
            level,
        };
        let expected = [
            entry("Using it", None, 0),
            entry("What", Some("a.md"), 0),
            entry("One", Some("guide/one.md"), 0),
            entry("Two", Some("two.md"), 1),
        ];
        assert_eq!(chapters, expected);
    }
}
