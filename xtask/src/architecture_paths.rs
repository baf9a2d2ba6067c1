//! Every path that ARCHITECTURE.md names exists.
//!
//! A path begins with a folder of the repository ([`ROOTS`]); `*` stands for any part of a file's name. A short name after it in the same
//! line (`stencil.rs`, `gloss/`) is in the same folder, or in the folder that the path is.

use crate::chore::{Failure, repository};
use std::path::{Path, PathBuf};

/// The folders that a path begins with.
const ROOTS: [&str; 8] = ["crates", "app", "xtask", "docs", "bridges", "tests", "assets", "farm"];

/// Ends of short names.
const SHORT_NAME_ENDS: [&str; 6] = [".rs", ".wgsl", ".py", ".sh", ".md", "/"];

/// Checks ARCHITECTURE.md.
///
/// # Errors
/// It cannot be read, or names a path that does not exist.
pub fn check() -> Result<(), Failure> {
    let file = repository().join("ARCHITECTURE.md");
    let text = std::fs::read_to_string(&file)
        .map_err(|e| Failure::new(format!("{}: cannot be read: {e}", file.display())))?;
    let missing = missing_paths(&text, &repository());
    if missing.is_empty() {
        return Ok(());
    }
    Err(Failure::new(format!("ARCHITECTURE.md names paths that do not exist:\n  {}", missing.join("\n  "))))
}

/// Paths in code spans of `text` that do not exist in the folder `root`, each with its line.
fn missing_paths(text: &str, root: &Path) -> Vec<String> {
    let mut missing = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let mut folder = None;
        for span in code_spans(line) {
            let exists = if is_full_path(span) {
                folder = Some(folder_of(root, span));
                exists(root, span)
            } else if is_short_name(span) {
                folder.as_deref().is_some_and(|folder| exists(folder, span))
            } else {
                true
            };
            if !exists {
                missing.push(format!("line {}: {span}", index + 1));
            }
        }
    }
    missing
}

/// What stands between backticks.
fn code_spans(line: &str) -> impl Iterator<Item = &str> {
    line.split('`').skip(1).step_by(2)
}

fn is_full_path(span: &str) -> bool {
    span.split_once('/').is_some_and(|(first, _)| ROOTS.contains(&first))
}

fn is_short_name(span: &str) -> bool {
    let is_command = span.contains(' ');
    !is_command && !span.starts_with('/') && SHORT_NAME_ENDS.iter().any(|end| span.ends_with(end))
}

/// Where short names after the path are looked up.
fn folder_of(root: &Path, path: &str) -> PathBuf {
    let path = root.join(path);
    if path.is_dir() { path } else { path.parent().map_or_else(|| root.into(), Path::to_path_buf) }
}

/// Whether there is something at `path` in `folder`; a path that ends with `/` is a folder's.
fn exists(folder: &Path, path: &str) -> bool {
    let Some((name, rest)) = path.split_once('/') else { return entries(folder, path).next().is_some() };
    entries(folder, name).any(|entry| entry.is_dir() && (rest.is_empty() || exists(&entry, rest)))
}

/// What in `folder` is called `pattern`, letter by letter, in which each `*` stands for any characters.
fn entries(folder: &Path, pattern: &str) -> impl Iterator<Item = PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .filter(move |entry| matches_glob(&entry.file_name().to_string_lossy(), pattern))
        .map(|entry| entry.path())
}

fn matches_glob(name: &str, pattern: &str) -> bool {
    let Some((head, tail)) = pattern.split_once('*') else { return name == pattern };
    let Some(rest) = name.strip_prefix(head) else { return false };
    rest.char_indices().map(|(at, _)| at).chain([rest.len()]).any(|at| matches_glob(&rest[at..], tail))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn architecture_names_paths_that_exist() {
        check().unwrap_or_else(|failure| panic!("{failure}"));
    }

    #[test]
    fn architecture_paths_that_exist_pass() {
        let text = "`crates/lens/src/optics.rs`, `aperture.rs`, `calibrated_lens/`; `crates/*/src/lib.rs`, `app/src`\n\
                    `xtask/src/demo.rs`, `demo/*.rs`; `and/or`, `lens::Optics`, `cargo xtask demo`, `--photos`";
        assert_eq!(missing_paths(text, &repository()), Vec::<String>::new());
    }

    #[test]
    fn architecture_paths_that_do_not_exist_are_found() {
        let wrong = [
            "`crates/lens/src/optic.rs`",             // a letter short
            "`crates/lens/src/optics.rs`, `blur.rs`", // a short name that is not beside it
            "`crates/lens/src/optics/`",              // a file, not a folder
            "`crates/lens/src/*.wgsl`",
            "`optics.rs` of `crates/lens/src`", // a short name before its folder
            "`app/src/Main.rs`",
        ];
        let expected = [
            "line 1: crates/lens/src/optic.rs",
            "line 2: blur.rs",
            "line 3: crates/lens/src/optics/",
            "line 4: crates/lens/src/*.wgsl",
            "line 5: optics.rs",
            "line 6: app/src/Main.rs",
        ];
        assert_eq!(missing_paths(&wrong.join("\n"), &repository()), expected);
    }
}
