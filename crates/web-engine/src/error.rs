//! Why a page's light field cannot be shown.

use salf::SalfFileError;
use splat::SplatError;

/// Why a page's light field cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The bytes are not those of a [`crate::FieldOfPage`].
    #[error("the page's light field is damaged: {0}")]
    Damaged(&'static str),
    /// The light field in it cannot be read.
    #[error("the page's light field is damaged: {0}")]
    LightField(#[from] SalfFileError),
    /// The picture cannot be summed.
    #[error("the picture cannot be summed: {0}")]
    Sum(#[from] SplatError),
    /// The lens cannot be used.
    #[error("{0}")]
    Lens(#[from] lens::CameraError),
}
