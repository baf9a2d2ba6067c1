//! The viewer is plain JavaScript, small, and its types hold.

use std::path::Path;
use std::process::Command;

/// How many bytes all of its scripts may have.
const MOST_BYTES: u64 = 40_000;

#[test]
fn the_viewer_is_small_and_its_types_hold() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/viewer");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scripts: Vec<_> = files.filter(|file| file.extension().is_some_and(|e| e == "js")).collect();
    let bytes: u64 = scripts.iter().map(|script| script.metadata().unwrap().len()).sum();
    assert!(scripts.len() > 5 && bytes <= MOST_BYTES, "{bytes} bytes in {} scripts", scripts.len());

    let folder = tempfile::tempdir().unwrap();
    let wrong = folder.path().join("wrong.js");
    std::fs::write(&wrong, "/** @type {number} */\nlet count = 'three';\n").unwrap();
    let check = |file: Option<&Path>| {
        let options = ["--noEmit", "--allowJs", "--checkJs", "--strict", "--target", "es2020"];
        let libraries = ["--lib", "es2021,dom,dom.iterable"];
        Command::new("tsc").args(options).args(libraries).args(&scripts).args(file).output()
    };
    let Ok(checked) = check(None) else {
        eprintln!(
            "SKIPPED: no tsc, so the viewer's types were not checked (apt-get install node-typescript)"
        );
        return;
    };
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));
    let checked = check(Some(&wrong)).unwrap();
    let complaint = String::from_utf8_lossy(&checked.stdout);
    assert!(!checked.status.success() && complaint.contains("wrong.js"), "{complaint}");
}
