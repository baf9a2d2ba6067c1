//! Errors of this crate.

use progress::Cancelled;
use scene::SceneError;
use std::path::PathBuf;

/// Why there is no atlas, or why one cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum AtlasError {
    /// The work was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// The scene has nothing to unwrap.
    #[error("the scene has no triangles (nothing to unwrap)")]
    NoTriangles,
    /// The charts do not fit even at one texel each.
    #[error(
        "{charts} separate pieces of surface do not fit an atlas of {side}×{side} texels (join the mesh's faces, or remove parts)"
    )]
    TooManyCharts {
        /// Number of charts.
        charts: usize,
        /// The maximum side of an atlas.
        side: u32,
    },
    /// The machine has too little memory.
    #[error("unwrapping ran out of memory (close other programs, and try again)")]
    OutOfMemory,
    /// Stored bytes are not an atlas, or not one of this scene.
    #[error("the stored atlas is unusable: {reason} (unwrap the scene again)")]
    Stored {
        /// What is wrong with them.
        reason: String,
    },
    /// The scene's file cannot be read again.
    #[error(transparent)]
    Scene(SceneError),
    /// The scene's file has changed since the scene was read.
    #[error("{}: has changed since it was opened (open it again)", path.display())]
    SceneChanged {
        /// The scene's file.
        path: PathBuf,
    },
    /// The exported file would be larger than the format allows.
    #[error(
        "the exported file would take {bytes} bytes, more than a GLB can hold (export fewer parts or smaller textures)"
    )]
    GlbTooLarge {
        /// Its size in bytes.
        bytes: u64,
    },
    /// A file could not be written.
    #[error("{}: {source} (check the folder and the free space)", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The error of the file system.
        source: std::io::Error,
    },
}

impl From<Cancelled> for AtlasError {
    fn from(_: Cancelled) -> Self {
        AtlasError::Cancelled
    }
}

impl From<SceneError> for AtlasError {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Cancelled(_) => AtlasError::Cancelled,
            other => AtlasError::Scene(other),
        }
    }
}
