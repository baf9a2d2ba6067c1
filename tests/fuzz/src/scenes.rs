//! Scenes in glTF.

use crate::folder::file;
use crate::outcome::read_or_refused;
use progress::Unwatched;
use scene::{AnimatedScene, AnimationTime, LoadOptions};
use std::sync::Arc;

/// Limits that a small file reaches soon.
pub(crate) fn limits() -> LoadOptions {
    LoadOptions {
        max_memory: 64 << 20,
        memory_per_file_byte: 0,
        max_triangles: 100_000,
        max_texels: 1 << 20,
        variant: None,
    }
}

/// Loads a glTF scene, and poses it where it is animated.
pub fn gltf(bytes: &[u8]) {
    let path = file("scene.glb", bytes);
    let Some(scene) = read_or_refused(scene::load(&path, &limits(), &Unwatched)) else { return };
    if let Some(animated) = read_or_refused(AnimatedScene::open(Arc::new(scene), &limits(), &Unwatched)) {
        if !animated.animations().is_empty() {
            let moment = AnimationTime { animation: None, seconds: 0.5 };
            read_or_refused(animated.pose_at(&moment, &Unwatched));
        }
    }
}
