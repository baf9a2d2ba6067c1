//! Long work in named steps, for whoever watches it.

use crate::lit_scene::LitScene;
use lens::{Camera, Picture};
use progress::{Progress, Unwatched};
use std::sync::Arc;

/// Who watches a piece of work that has several steps.
pub trait Steps: Sync {
    /// The next step begins; its progress goes to what is returned.
    fn begin(&self, label: &str) -> Box<dyn Progress + '_>;

    /// A step found something worth a sentence.
    fn notice(&self, _sentence: &str) {}

    /// The scene can be seen through `camera`, though it takes a while until it can be painted on.
    fn scene_ready(&self, _scene: &Arc<LitScene>, _camera: &Camera) {}

    /// The picture of what is being opened is there, though it takes a while until it has a surface.
    fn picture_ready(&self, _picture: &Picture) {}
}

/// Nobody watches.
impl Steps for Unwatched {
    fn begin(&self, _label: &str) -> Box<dyn Progress + '_> {
        Box::new(Unwatched)
    }
}
