//! The pages of the book, and the README.

use std::path::{Path, PathBuf};

/// The root of the repository.
pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// All pages, in order of their names.
pub fn pages() -> Vec<PathBuf> {
    let mut pages = vec![repository().join("README.md"), repository().join("ARCHITECTURE.md")];
    for folder in ["docs", "docs/notebook"] {
        let entries = std::fs::read_dir(repository().join(folder)).unwrap();
        let files = entries.map(|entry| entry.unwrap().path());
        pages.extend(files.filter(|file| file.extension().is_some_and(|e| e == "md")));
    }
    pages.sort();
    pages
}

/// A line of a page, and whether it stands in a block of code; how the block's fence is called, if it has one.
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
