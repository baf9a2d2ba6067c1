//! The steps of a background job, as shown by its progress bar.

use jobs::JobProgress;
use light::Steps;
use progress::Progress;

/// Maps the steps of a background job to its progress bar. Each step takes a fixed share of what is left, so that the bar never runs
/// back, however many steps there are.
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
