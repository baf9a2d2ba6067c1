//! Where the demo lies: beside the program, in its share folder, or in the source tree it was built from.

use session::Command;
use std::path::{Path, PathBuf};

/// The command that opens the demo: its scene as its makers shot and focused it. None where it is not installed.
pub fn open() -> Option<Command> {
    let program = std::env::current_exe().ok();
    let beside = program.as_deref().and_then(Path::parent);
    let folders = [
        beside.map(|folder| folder.join("assets/demo")),
        beside.map(|folder| folder.join("../share/focus-brush/demo")),
        Some(Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/demo")),
        Some(PathBuf::from("assets/demo")),
    ];
    let folder = folders.into_iter().flatten().find(|folder| folder.join("demo.glb").is_file())?;
    let folder = folder.canonicalize().unwrap_or(folder);
    let file = |name| folder.join(name);
    Some(Command::OpenShot {
        scene: file("demo.glb"),
        camera: file("demo.camera.json"),
        focus: file("demo.focus.json"),
    })
}
