//! Errors of invalid cameras.

/// An invalid field of a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraError {
    /// The field.
    pub field: &'static str,
    /// What it must be.
    pub must: &'static str,
}

impl std::fmt::Display for CameraError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "camera: {} must be {}", self.field, self.must)
    }
}

impl std::error::Error for CameraError {}
