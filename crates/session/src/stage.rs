//! What stays while a document is open: the scene, its atlas and what answers rays and dabs on it.

use crate::SessionError;
use atlas::Atlas;
use focus::Canvas;
use progress::Progress;
use scene::{LoadOptions, Scene, SceneError};
use std::path::Path;
use std::sync::Arc;
use trace::Tracer;

/// A scene that can be painted on.
pub struct Stage {
    /// The scene.
    pub scene: Arc<Scene>,
    /// Where its triangles lie in the focus map.
    pub atlas: Arc<Atlas>,
    /// What answers rays.
    pub tracer: Arc<Tracer>,
    /// What dabs are painted on.
    pub canvas: Arc<Canvas>,
}

impl From<SceneError> for SessionError {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Cancelled(_) => Self::Cancelled,
            other => Self::BadInput(other.to_string()),
        }
    }
}

/// Reads a scene within the usual limits.
pub fn load_scene(path: &Path, progress: &dyn Progress) -> Result<Arc<Scene>, SessionError> {
    Ok(Arc::new(scene::load(path, &LoadOptions::default(), progress)?))
}

impl Stage {
    /// Unwraps `scene` and prepares it for rays and dabs.
    pub fn unwrap(scene: Arc<Scene>, progress: &dyn Progress) -> Result<Self, SessionError> {
        progress.check()?;
        Err(SessionError::Internal(format!("{}: scenes cannot be unwrapped yet", scene.path.display())))
    }

    /// Prepares a scene whose atlas is known.
    pub fn of(scene: Arc<Scene>, atlas: Arc<Atlas>, progress: &dyn Progress) -> Result<Self, SessionError> {
        progress.check()?;
        let tracer = Arc::new(Tracer::new(scene.clone()));
        progress.report(0.3);
        progress.check()?;
        let canvas = Arc::new(Canvas::new(&scene, &atlas, &atlas.texels(&scene), &[]));
        progress.report(1.0);
        Ok(Self { scene, atlas, tracer, canvas })
    }
}
