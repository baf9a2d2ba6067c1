//! Reads scene files; their errors, and those of their atlases, as document errors.

use crate::error::DocumentError;
use atlas::AtlasError;
use progress::Progress;
use scene::{LoadOptions, Scene, SceneError};
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
    Ok(load_variant(path, None, progress)?)
}

/// Reads a scene file, of meshes or splats, within the default limits, in one of its variants; `None`: with its own materials.
pub(crate) fn load_variant(
    path: &Path,
    variant: Option<&str>,
    progress: &dyn Progress,
) -> Result<Arc<Scene>, SceneError> {
    if gaussians::may_be_splats(path) {
        return Ok(Arc::new(scene::load_splats(path, variant, progress)?));
    }
    let options = LoadOptions { variant: variant.map(String::from), ..LoadOptions::default() };
    Ok(Arc::new(scene::load(path, &options, progress)?))
}
