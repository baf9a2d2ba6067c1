//! Locates what comes with the program: beside it, in its share folder, or in the source tree it was built from.

use std::path::{Path, PathBuf};

/// A file `name` that is installed in the folder `shared` below the prefix of the program, and stands in the folder `source` of the source
/// tree. `None` if it is in neither.
pub fn find(shared: &str, source: &str, name: &str) -> Option<PathBuf> {
    let program = std::env::current_exe().ok();
    let beside = program.as_deref().and_then(Path::parent);
    let folders = [
        beside.map(|folder| folder.join(source)),
        beside.map(|folder| folder.join("..").join(shared)),
        Some(Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(source)),
        Some(PathBuf::from(source)),
    ];
    let file = folders.into_iter().flatten().map(|folder| folder.join(name)).find(|file| file.is_file())?;
    Some(dunce::canonicalize(&file).unwrap_or(file))
}
