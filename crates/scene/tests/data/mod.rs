//! Where the shared test data lies, and what is in it.

#![allow(dead_code, reason = "each file of tests needs a part of it")]

use std::path::{Path, PathBuf};

/// A folder of the shared test data; says so loudly if it is absent.
pub fn folder(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("SKIPPED: there is no {}", folder.display());
    None
}

/// All .glb and .gltf files below a folder, sorted.
pub fn scenes(folder: &Path) -> Vec<PathBuf> {
    let (mut found, mut folders) = (Vec::new(), vec![folder.to_path_buf()]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.extension().and_then(|extension| extension.to_str()) {
                _ if path.is_dir() => folders.push(path),
                Some("glb" | "gltf") => found.push(path),
                _ => {}
            }
        }
    }
    found.sort();
    found
}
