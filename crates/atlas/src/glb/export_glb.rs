//! The scene's file with its atlas as an additional UV set, in [0, 1], as a GLB.
//!
//! The file is read again, and its content is preserved: the document as it was, the data byte for byte. The steps,
//! one file each:
//!
//! ```text
//! file ─▶ glb_document (its buffers and images become one chunk)
//!           └▶ placed_meshes (one mesh per instance)
//!                └▶ split_vertices (at the seams) ─▶ placed_primitive ─▶ uv_set, vertex_attributes
//! ```

use crate::glb::glb_document::GlbDocument;
use crate::glb::placed_meshes::{self, PlacementStop};
use crate::{Atlas, AtlasError};
use progress::{Progress, Stage};
use scene::{GltfSource, LoadOptions, Scene, SceneError};
use serde_json::{Map, Value};
use std::path::Path;

/// Fraction of the work spent on reading the file.
const READING_SHARE: f32 = 0.5;

/// Writes the scene's file with its atlas to `path`, replacing an existing file only once the new one is complete.
///
/// # Errors
/// The scene's file cannot be read again or has changed; the result cannot be written or is too large for a GLB; the
/// work was cancelled. An existing file then stays as it was.
pub fn write_glb(
    scene: &Scene,
    atlas: &Atlas,
    path: &Path,
    progress: &dyn Progress,
) -> Result<(), AtlasError> {
    write_amended_glb(scene, atlas, path, &|_| {}, progress)
}

/// As [`write_glb`], with `amend` applied to the document before it is written.
///
/// # Errors
/// As [`write_glb`].
pub fn write_amended_glb(
    scene: &Scene,
    atlas: &Atlas,
    path: &Path,
    amend: &dyn Fn(&mut Map<String, Value>),
    progress: &dyn Progress,
) -> Result<(), AtlasError> {
    let bytes = amended_glb_bytes(scene, atlas, amend, progress)?;
    progress.check()?;
    write_atomically(path, &bytes)
}

/// Writes a file atomically: an existing one is replaced only once the new one is complete.
pub(crate) fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), AtlasError> {
    atomic_file::write(path, bytes).map_err(|source| AtlasError::Write { path: path.to_owned(), source })
}

/// The bytes of the GLB file that [`write_glb`] writes. The atlas must be of this scene.
///
/// # Errors
/// The scene's file cannot be read again or has changed; the result is too large for a GLB; the work was cancelled.
pub fn glb_bytes(scene: &Scene, atlas: &Atlas, progress: &dyn Progress) -> Result<Vec<u8>, AtlasError> {
    amended_glb_bytes(scene, atlas, &|_| {}, progress)
}

fn amended_glb_bytes(
    scene: &Scene,
    atlas: &Atlas,
    amend: &dyn Fn(&mut Map<String, Value>),
    progress: &dyn Progress,
) -> Result<Vec<u8>, AtlasError> {
    let reading = Stage::new(progress, 0.0, READING_SHARE);
    let placing = Stage::new(progress, READING_SHARE, 1.0);
    scene::with_source(&scene.path, &LoadOptions::default(), &reading, |source| {
        if !matches_source(scene, source) {
            return Err(AtlasError::SceneChanged { path: scene.path.clone() });
        }
        let stopped = |stop: PlacementStop| match stop {
            PlacementStop::Fault(fault) => SceneError::Bad { file: scene.path.clone(), fault }.into(),
            PlacementStop::SourceMismatch => AtlasError::SceneChanged { path: scene.path.clone() },
            PlacementStop::Cancelled => AtlasError::Cancelled,
        };
        let mut glb = GlbDocument::from_source(source).map_err(|fault| stopped(fault.into()))?;
        placed_meshes::place_meshes(&mut glb, source, atlas, &placing).map_err(stopped)?;
        amend(glb.root_mut());
        glb.into_bytes()
    })?
}

/// Whether the file still contains the scene.
fn matches_source(scene: &Scene, source: &GltfSource<'_>) -> bool {
    source.scene.is_surface_of(scene) && source.parts.len() == source.scene.parts.len()
}
