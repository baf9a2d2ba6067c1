//! Every character of the window's texts is in its fonts: what is not would be shown as a box.

use crate::acting::Person;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Where the window's texts are written.
const SOURCES: [&str; 4] =
    ["app/src/window", "crates/session/src", "crates/document/src/editing", "crates/focus/src/layers"];

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Characters beyond ASCII outside comments, with the file of one of them.
fn characters() -> BTreeMap<char, PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    SOURCES.iter().for_each(|source| rust_files(&root.join(source), &mut files));
    assert!(files.len() > 100, "{} files", files.len());
    let mut found = BTreeMap::new();
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a source file");
        let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
        for character in lines.flat_map(str::chars).filter(|character| !character.is_ascii()) {
            found.entry(character).or_insert_with(|| file.clone());
        }
    }
    found
}

#[test]
fn no_character_is_shown_as_a_box() {
    let mut person = Person::starts(None);
    person.window.run_steps(2);
    let characters = characters();
    assert!(characters.contains_key(&'×'), "there are some: {characters:?}");
    for style in [egui::TextStyle::Body, egui::TextStyle::Button, egui::TextStyle::Monospace] {
        let font = style.resolve(&person.window.ctx.global_style());
        let missing: Vec<_> = person.window.ctx.fonts_mut(|fonts| {
            characters.iter().filter(|(character, _)| !fonts.has_glyph(&font, **character)).collect()
        });
        assert!(missing.is_empty(), "{style:?} has no {missing:?}");
    }
    let font = egui::TextStyle::Body.resolve(&person.window.ctx.global_style());
    assert!(!person.window.ctx.fonts_mut(|fonts| fonts.has_glyph(&font, '\u{10ffff}')), "a box is noticed");
}
