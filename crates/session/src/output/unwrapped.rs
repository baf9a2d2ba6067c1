//! Scenes with their atlas, as files.

use crate::document::atlas_error;
use crate::error::SessionError;
use crate::jobs::Steps;
use atlas::Atlas;
use scene::Scene;
use std::path::Path;

/// Writes `scene` as GLB with `atlas` as its second UV set.
pub fn write_unwrapped(
    path: &Path,
    scene: &Scene,
    atlas: &Atlas,
    steps: &dyn Steps,
) -> Result<(), SessionError> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb")) {
        return Err(SessionError::bad(path, "unwrapped scenes are written as .glb (name one)"));
    }
    atlas::write_glb(scene, atlas, path, &*steps.begin("writing")).map_err(|error| atlas_error(path, error))
}
