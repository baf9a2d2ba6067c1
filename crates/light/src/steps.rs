//! Long work in named steps, and its observers.

use crate::lit_scene::LitScene;
use lens::{Camera, Picture};
use progress::{Progress, Unwatched};
use std::sync::Arc;

/// Observes work that has several steps.
pub trait Steps: Sync {
    /// The next step begins; it reports its progress to the returned object.
    fn begin(&self, label: &str) -> Box<dyn Progress + '_>;

    /// A step has a message for the user, one sentence.
    fn notice(&self, _sentence: &str) {}

    /// The scene can be shown through `camera`, though it cannot be painted on yet. Where it `is_painted`, how it is focused is not known.
    fn scene_ready(&self, _scene: &Arc<LitScene>, _camera: &Camera, _is_painted: bool) {}

    /// The picture of what is being opened can be shown, though it has no surface yet.
    fn picture_ready(&self, _picture: &Picture) {}
}

/// Without an observer.
impl Steps for Unwatched {
    fn begin(&self, _label: &str) -> Box<dyn Progress + '_> {
        Box::new(Unwatched)
    }
}
