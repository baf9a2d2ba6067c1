//! Reads scene files; their errors, and those of their atlases, as document errors.

use crate::error::DocumentError;
use atlas::AtlasError;
use progress::Progress;
use project::SplatsFile;
use scene::{Floor, LoadOptions, Scene, SceneError};
use std::path::Path;
use std::sync::Arc;

impl From<SceneError> for DocumentError {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Cancelled(_) => Self::Cancelled,
            other => Self::BadInput(other.to_string()),
        }
    }
}

/// The error of the atlas of the scene at `path`, as a document error.
pub fn atlas_error(path: &Path, error: AtlasError) -> DocumentError {
    match error {
        AtlasError::Cancelled => DocumentError::Cancelled,
        AtlasError::Write { path, source } => DocumentError::io(&path, &source),
        AtlasError::OutOfMemory => DocumentError::TryAgain(format!("{}: {error}", path.display())),
        other => DocumentError::bad_file(path, other),
    }
}

/// Reads a scene file within the default limits.
///
/// # Errors
/// The file cannot be read or used, or `progress` cancels.
pub fn load_scene(path: &Path, progress: &dyn Progress) -> Result<Arc<Scene>, DocumentError> {
    Ok(load_variant(path, None, None, progress)?)
}

/// Reads a scene file, of meshes or splats, within the default limits, in one of its variants; `None`: with its own materials. Splats are added or
/// shown as `splats` says.
pub(crate) fn load_variant(
    path: &Path,
    variant: Option<&str>,
    splats: Option<&SplatsFile>,
    progress: &dyn Progress,
) -> Result<Arc<Scene>, SceneError> {
    let options = LoadOptions { variant: variant.map(String::from), ..LoadOptions::default() };
    let mut scene = match gaussians::may_be_splats(path) {
        true => scene::load_splats(path, variant, progress)?,
        false => scene::load(path, &options, progress)?,
    };
    if let Some(splats) = splats {
        show_splats(&mut scene, splats, progress)?;
    }
    Ok(Arc::new(scene))
}

/// Puts a floor under the scene at `path` that catches its shadows, unless it has one, and shows it or not. Returns a floor that is new.
///
/// # Errors
/// The scene casts no shadow.
pub(crate) fn add_floor(
    scene: &mut Scene,
    is_shown: bool,
    path: &Path,
) -> Result<Option<Floor>, DocumentError> {
    if let Some(problem) = scene.floor_problem() {
        let message = format!("a floor would catch no shadow: {problem} (leave the floor out)");
        return Err(DocumentError::bad_file(path, message));
    }
    let is_new = scene.floor.is_none();
    scene.set_floor(is_shown);
    Ok(scene.floor.filter(|_| is_new))
}

/// Adds splats to a scene that was read, if they are of another file; and shows them as `splats` says.
///
/// # Errors
/// Their file cannot be used, or the scene has splats of another; or `progress` cancels.
pub(crate) fn show_splats(
    scene: &mut Scene,
    splats: &SplatsFile,
    progress: &dyn Progress,
) -> Result<(), SceneError> {
    let shown = scene.splats.as_ref().and_then(|shown| shown.file.as_ref());
    if let Some(file) = splats.file.as_deref().filter(|file| shown.is_none_or(|shown| shown != file)) {
        scene::add_splat_file(scene, file, progress)?;
    }
    scene.edit_splats(splats.edit.clone());
    Ok(())
}
