//! Where the demo lies: beside the program, in its share folder, or in the source tree it was built from.

use std::path::{Path, PathBuf};

/// The demo's files, the best first: the painted project, else the bare scene.
const NAMES: [&str; 2] = ["demo.fbrush", "demo.glb"];

/// The demo, if it was installed or is in the source tree.
pub fn find() -> Option<PathBuf> {
    let program = std::env::current_exe().ok();
    let beside = program.as_deref().and_then(Path::parent);
    let folders = [
        beside.map(|folder| folder.join("assets/demo")),
        beside.map(|folder| folder.join("../share/focus-brush/demo")),
        Some(Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/demo")),
        Some(PathBuf::from("assets/demo")),
    ];
    let files = folders.into_iter().flatten().flat_map(|folder| NAMES.map(|name| folder.join(name)));
    let found = files.into_iter().find(|file| file.is_file())?;
    Some(found.canonicalize().unwrap_or(found))
}
