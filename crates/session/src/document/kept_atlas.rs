//! Atlases kept from one run of the program to the next: a scene of many triangles is not unwrapped anew each time it is opened.

use super::picture_scene::picture_atlas;
use super::scene_hashes::surface_hash;
use crate::kept_files::DiskCache;
use atlas::{Atlas, AtlasError, UnwrapOptions};
use progress::Progress;
use scene::Scene;
use sha2::Digest;
use std::time::{Duration, Instant};

/// 28 bytes a triangle each.
const CACHE: DiskCache = DiskCache { name: "atlas", budget_bytes: 512 << 20 };

/// What is unwrapped in less time is unwrapped again.
const MIN_CACHED_DURATION: Duration = Duration::from_secs(1);

/// The atlas of a scene: that of its picture, the kept one, or the scene unwrapped.
pub(crate) fn load_or_unwrap_atlas(
    scene: &Scene,
    options: &UnwrapOptions,
    progress: &dyn Progress,
) -> Result<Atlas, AtlasError> {
    if let Some(atlas) = picture_atlas(scene) {
        return Ok(atlas);
    }
    let file = CACHE.entry_path(|hash| {
        let UnwrapOptions { density, gutter, uv, child, deadline: _ } = options;
        hash.update(surface_hash(scene));
        hash.update(format!("{density:?} {gutter} {uv:?} {}", child.is_some()));
    });
    let cached = file.as_ref().and_then(|file| CACHE.read(file));
    if let Some(atlas) = cached.and_then(|bytes| Atlas::from_bytes(&bytes, scene).ok()) {
        return Ok(atlas);
    }
    let start = Instant::now();
    let atlas = Atlas::unwrap(scene, options, progress)?;
    // What did not go as asked may go another time, and is not stored.
    if let Some(file) = file.filter(|_| start.elapsed() >= MIN_CACHED_DURATION && atlas.notes.is_empty()) {
        CACHE.write(&file, &atlas.to_bytes());
    }
    Ok(atlas)
}
