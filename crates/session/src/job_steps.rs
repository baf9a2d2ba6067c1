//! The steps of a background job, as its progress bar shows them.

use jobs::JobProgress;
use light::Steps;
use progress::Progress;

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
