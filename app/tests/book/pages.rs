//! The pages of the book, and the README and other pages at the root.

use std::path::{Path, PathBuf};

/// The root of the repository.
pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// All pages, in order of their names.
pub fn pages() -> Vec<PathBuf> {
    let beside = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md"];
    let mut pages: Vec<_> = beside.iter().map(|name| repository().join(name)).collect();
    let mut folders = vec![repository().join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "md") {
                pages.push(path);
            }
        }
    }
    pages.sort();
    pages
}

/// A line of a page, whether it is in a code block, and the name on the block's fence, if any.
pub struct Line<'a> {
    pub number: usize,
    pub text: &'a str,
    pub block: Option<&'a str>,
}

/// The lines of a page.
pub fn lines(text: &str) -> Vec<Line<'_>> {
    let mut fence: Option<&str> = None;
    let mut lines = Vec::new();
    for (number, text) in (1..).zip(text.lines()) {
        if let Some(after) = text.trim_start().strip_prefix("```") {
            fence = match fence {
                None => Some(after.trim()),
                Some(_) => None,
            };
            continue;
        }
        let indented = text.starts_with("    ").then_some("");
        lines.push(Line { number, text, block: fence.or(indented) });
    }
    lines
}
