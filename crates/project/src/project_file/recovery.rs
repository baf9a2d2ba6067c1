//! Recovery files: unsaved work, for after a crash.
//!
//! A recovery file is a project file under another name. The session writes it periodically, removes it on saving and
//! closing, and offers it if it exists on opening.

use crate::disk::with_suffix;
use crate::project_file::manifest::sha256_hex;
use crate::{ProjectError, ProjectFile};
use std::path::{Path, PathBuf};

/// Appended to the project's name.
const SUFFIX: &str = ".recovery";

/// The recovery file of a project, in the same folder: `NAME.fbrush.recovery`.
pub fn recovery_path_for(project: &Path) -> PathBuf {
    with_suffix(project, SUFFIX)
}

/// The recovery file of a document that was never saved: in the user's data folder (the temporary folder if there is
/// none), named after the scene's path. Creates the folder if missing.
pub fn unsaved_recovery_path(scene: &Path) -> PathBuf {
    let folders = directories::ProjectDirs::from("", "", "focus-brush");
    let data = folders.map_or_else(std::env::temp_dir, |folders| folders.data_local_dir().to_owned());
    let folder = data.join("recovery");
    let folder = if std::fs::create_dir_all(&folder).is_ok() { folder } else { std::env::temp_dir() };
    let scene = std::path::absolute(scene).unwrap_or_else(|_| scene.to_owned());
    let stem = scene.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let hash = &sha256_hex(scene.as_os_str().as_encoded_bytes())[..12];
    folder.join(format!("{stem}-{hash}.{}{SUFFIX}", ProjectFile::EXTENSION))
}

/// Loads the recovery file, if it exists and is newer than `project` (or `project` does not exist). One that cannot
/// be read is ignored.
pub fn find_recovery(recovery: &Path, project: Option<&Path>) -> Option<ProjectFile> {
    let modified = |file: &Path| std::fs::metadata(file).and_then(|data| data.modified()).ok();
    let written = modified(recovery)?;
    let is_newer = project.and_then(modified).is_none_or(|saved| written >= saved);
    if is_newer { ProjectFile::load(recovery).ok() } else { None }
}

/// Removes a recovery file; does nothing if there is none.
///
/// # Errors
/// The file system refuses.
pub fn remove_recovery(recovery: &Path) -> Result<(), ProjectError> {
    match std::fs::remove_file(recovery) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(ProjectError::Write { file: recovery.to_owned(), source })
        }
        _ => Ok(()),
    }
}
