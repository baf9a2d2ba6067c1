//! Atlases cached on disk, so that a scene of many triangles is not unwrapped each time it is opened.

use crate::disk_cache::{CacheSection, DiskCache};
use crate::scene_hashes::surface_hash;
use atlas::{Atlas, AtlasError, UnwrapOptions};
use progress::Progress;
use scene::Scene;
use sha2::Digest;

/// An atlas takes 28 bytes per triangle.
const SECTION: CacheSection = CacheSection { name: "atlas", budget_bytes: 512 << 20 };

/// Scenes of fewer triangles unwrap in about a second and are not cached.
const MIN_CACHED_TRIANGLES: usize = 8_000;

/// The atlas of a scene: read from the cache, or else unwrapped.
///
/// # Errors
/// Those of [`Atlas::unwrap`].
pub fn load_or_unwrap_atlas(
    scene: &Scene,
    options: &UnwrapOptions,
    cache: &DiskCache,
    progress: &dyn Progress,
) -> Result<Atlas, AtlasError> {
    let entry = cache.entry(SECTION, |hash| {
        let UnwrapOptions { density, gutter, uv, child, child_arguments: _, deadline: _ } = options;
        hash.update(surface_hash(scene));
        hash.update(format!("{density:?} {gutter} {uv:?} {}", child.is_some()));
    });
    let cached = entry.as_ref().and_then(|entry| entry.read());
    if let Some(atlas) = cached.and_then(|bytes| Atlas::from_bytes(&bytes, scene).ok()) {
        return Ok(atlas);
    }
    let atlas = Atlas::unwrap(scene, options, progress)?;
    // An atlas that was not made as requested might be another time, and is not stored.
    if let Some(entry) =
        entry.filter(|_| scene.triangles.len() >= MIN_CACHED_TRIANGLES && atlas.notes.is_empty())
    {
        entry.write(&atlas.to_bytes());
    }
    Ok(atlas)
}
