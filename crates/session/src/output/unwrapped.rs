//! Scenes with their atlas, as files.

use super::shot_extras::tell_lens;
use crate::document::atlas_error;
use crate::error::SessionError;
use crate::jobs::Steps;
use atlas::Atlas;
use lens::Camera;
use scene::Scene;
use serde_json::{Map, Value};
use std::path::Path;

/// Writes `scene` as GLB with `atlas` as its second UV set, and, if there is one, with the lens of a shot camera in its extras.
pub fn write_unwrapped(
    path: &Path,
    scene: &Scene,
    atlas: &Atlas,
    shot: Option<&Camera>,
    steps: &dyn Steps,
) -> Result<(), SessionError> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb")) {
        return Err(SessionError::bad(path, "unwrapped scenes are written as .glb (name one)"));
    }
    let amend = |root: &mut Map<String, Value>| {
        if let Some(shot) = shot {
            tell_lens(root, scene, shot);
        }
    };
    atlas::write_amended_glb(scene, atlas, path, &amend, &*steps.begin("writing"))
        .map_err(|error| atlas_error(path, error))
}
