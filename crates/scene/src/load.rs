//! From a file to a scene.

use crate::{Inspection, LoadOptions, Scene, SceneError};
use progress::Progress;
use std::path::Path;

/// Reads a .glb or .gltf file.
pub fn load(_path: &Path, _options: &LoadOptions, _progress: &dyn Progress) -> Result<Scene, SceneError> {
    todo!()
}

/// Says what is in a .glb or .gltf file; unlike [`load`] it also opens files without a triangle.
pub fn inspect(_path: &Path) -> Result<Inspection, SceneError> {
    todo!()
}
