//! Long work in named steps, for whoever watches it.

use super::job_progress::JobProgress;
use lens::{Camera, Picture};
use progress::{Progress, Unwatched};
use std::sync::Arc;
use trace::Tracer;

/// Who watches a piece of work that has several steps.
pub trait Steps: Sync {
    /// The next step begins; its progress goes to what is returned.
    fn begin(&self, label: &str) -> Box<dyn Progress + '_>;

    /// A step found something worth a sentence.
    fn notice(&self, _sentence: &str) {}

    /// The scene can be seen through `camera`, though it takes a while until it can be painted on.
    fn scene_ready(&self, _tracer: &Arc<Tracer>, _camera: &Camera) {}

    /// The picture of what is being opened is there, though it takes a while until it has a surface.
    fn picture_ready(&self, _picture: &Picture) {}
}

/// Nobody watches.
impl Steps for Unwatched {
    fn begin(&self, _label: &str) -> Box<dyn Progress + '_> {
        Box::new(Unwatched)
    }
}

/// The steps of a background job, each an equal share of what the steps before it have left, so that the bar
/// never runs back however many there are.
pub(crate) struct JobSteps<'a> {
    pub progress: &'a JobProgress,
}

impl Steps for JobSteps<'_> {
    fn begin(&self, label: &str) -> Box<dyn Progress + '_> {
        let start = self.progress.fraction();
        let end = start + (1.0 - start) * 0.6;
        self.progress.begin_step(label, start, end);
        Box::new(progress::Stage::new(self.progress, start, end))
    }
}
