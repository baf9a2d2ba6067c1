//! The viewers are plain JavaScript, small, and their types hold.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// How many bytes all scripts of a page may have.
const MOST_BYTES: u64 = 40_000;

/// The scripts of a page: those that the Rust file which makes it includes.
fn scripts_of(page: &str) -> Vec<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let text = std::fs::read_to_string(source.join(page)).unwrap();
    let includes = text.split("include_str!(\"").skip(1).filter_map(|rest| rest.split('"').next());
    includes.filter(|file| file.ends_with(".js")).map(|file| source.join(file)).collect()
}

/// What the compiler says of scripts; `None` without one.
fn check(scripts: &[PathBuf]) -> Option<Output> {
    let options = ["--noEmit", "--allowJs", "--checkJs", "--strict", "--target", "es2021"];
    let libraries = ["--lib", "es2021,dom,dom.iterable"];
    Command::new("tsc").args(options).args(libraries).args(scripts).output().ok()
}

#[test]
fn the_viewers_are_small_and_their_types_hold() {
    let folder = tempfile::tempdir().unwrap();
    let wrong = folder.path().join("wrong.js");
    std::fs::write(&wrong, "/** @type {number} */\nlet count = 'three';\n").unwrap();
    for page in ["page.rs", "engine_page.rs"] {
        let scripts = scripts_of(page);
        let bytes: u64 = scripts.iter().map(|script| script.metadata().unwrap().len()).sum();
        assert!(
            scripts.len() > 5 && bytes <= MOST_BYTES,
            "{page}: {bytes} bytes in {} scripts",
            scripts.len()
        );
        let Some(checked) = check(&scripts) else {
            eprintln!(
                "SKIPPED: no tsc, so the viewers' types were not checked (apt-get install node-typescript)"
            );
            return;
        };
        assert!(checked.status.success(), "{page}: {}", String::from_utf8_lossy(&checked.stdout));
        let with_wrong: Vec<_> = scripts.iter().chain([&wrong]).cloned().collect();
        let checked = check(&with_wrong).unwrap();
        let complaint = String::from_utf8_lossy(&checked.stdout);
        assert!(!checked.status.success() && complaint.contains("wrong.js"), "{complaint}");
    }
    // No script is left out of both pages.
    let all = ["page.rs", "engine_page.rs"].map(scripts_of).concat();
    for folder in ["src/viewer", "src/viewer/engine"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        for entry in std::fs::read_dir(folder).unwrap() {
            let file = entry.unwrap().path();
            assert!(file.extension().is_none_or(|e| e != "js") || all.contains(&file), "{}", file.display());
        }
    }
}
