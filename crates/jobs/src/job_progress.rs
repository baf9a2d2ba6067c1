//! Progress and cancellation of background work, shared between the work and its observers.

use progress::{Part, Progress};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Progress and cancellation, shared between a job and its observers.
pub struct JobProgress {
    fraction: AtomicU32,
    cancelled: AtomicBool,
    step: Mutex<Step>,
}

/// A step of a job.
struct Step {
    label: String,
    start: Instant,
    /// The share of the whole job that is done before and after it.
    shares: [f32; 2],
}

impl Default for Step {
    fn default() -> Self {
        Self { label: String::new(), start: Instant::now(), shares: [0.0, 1.0] }
    }
}

impl Default for JobProgress {
    fn default() -> Self {
        Self { fraction: AtomicU32::new(0), cancelled: AtomicBool::new(false), step: Mutex::default() }
    }
}

/// The remaining time is estimated once a step has run for this long and this share of it is done.
const ESTIMATE_AFTER: (Duration, f32) = (Duration::from_secs(1), 0.02);

impl JobProgress {
    /// The share done, in [0, 1].
    pub fn fraction(&self) -> f32 {
        f32::from_bits(self.fraction.load(Ordering::Relaxed))
    }

    /// Asks the work to stop.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Starts over: nothing done, not cancelled.
    pub fn reset(&self) {
        self.cancelled.store(false, Ordering::Relaxed);
        self.begin_step("", 0.0, 1.0);
    }

    /// Begins a step that takes the progress bar from one share of the whole to another.
    pub fn begin_step(&self, label: &str, from: f32, to: f32) {
        let mut step = self.step();
        self.fraction.store(from.to_bits(), Ordering::Relaxed);
        *step = Step { label: label.into(), start: Instant::now(), shares: [from, to] };
    }

    /// The current step's name, and the estimated seconds until it is done.
    pub fn step_status(&self) -> (String, Option<u32>) {
        let step = self.step();
        (step.label.clone(), step.seconds_left(self.fraction(), step.start.elapsed()))
    }

    /// Ignores poisoning: the guarded value is only ever replaced as a whole.
    fn step(&self) -> MutexGuard<'_, Step> {
        self.step.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Step {
    /// Estimated seconds until the step is done, if after `elapsed` the whole job is done to the share `fraction`.
    fn seconds_left(&self, fraction: f32, elapsed: Duration) -> Option<u32> {
        let [from, to] = self.shares;
        let step_share = (fraction - from) / (to - from);
        let has_estimate = elapsed >= ESTIMATE_AFTER.0 && step_share >= ESTIMATE_AFTER.1;
        has_estimate.then(|| (elapsed.as_secs_f32() * (1.0 - step_share).max(0.0) / step_share).ceil() as u32)
    }
}

impl Progress for JobProgress {
    fn report(&self, fraction: f32) {
        self.fraction.fetch_max(fraction.clamp(0.0, 1.0).to_bits(), Ordering::Relaxed);
    }
    fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
    fn begin_part(&self, part: &Part) {
        *self.step() = Step { label: part.name.into(), start: Instant::now(), shares: [part.from, part.to] };
        self.report(part.from);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use progress::Stage;

    #[test]
    fn the_remaining_time_follows_from_the_share_done() {
        let step = Step { shares: [0.5, 0.9], ..Step::default() };
        let after = |seconds, fraction| step.seconds_left(fraction, Duration::from_secs(seconds));
        assert_eq!(after(10, 0.6), Some(30), "a quarter in ten seconds");
        assert_eq!(after(10, 0.9), Some(0));
        assert_eq!(after(10, 0.5), None, "nothing is done");
        assert_eq!(after(0, 0.6), None, "it has just begun");
        let progress = JobProgress::default();
        progress.report(0.7);
        progress.begin_step("baking", 0.5, 0.9);
        assert_eq!((progress.step_status().0.as_str(), progress.fraction()), ("baking", 0.5));
        progress.report(0.4);
        assert_eq!(progress.fraction(), 0.5, "it never runs back");
        let baking = Stage::new(&progress, 0.5, 1.0);
        Stage::named(&baking, "rays", 0.25, 0.75).report(0.5);
        let (label, _) = progress.step_status();
        assert_eq!(
            (label.as_str(), progress.fraction(), progress.step().shares),
            ("rays", 0.75, [0.625, 0.875])
        );
    }
}
