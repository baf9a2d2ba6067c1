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
    /// The estimate that is shown, s, and when after the start it was made.
    estimate: Option<(f32, Duration)>,
}

impl Default for Step {
    fn default() -> Self {
        Self::new("", [0.0, 1.0])
    }
}

impl Default for JobProgress {
    fn default() -> Self {
        Self { fraction: AtomicU32::new(0), cancelled: AtomicBool::new(false), step: Mutex::default() }
    }
}

/// The remaining time is estimated once a step has run for this long and this share of it is done.
const ESTIMATE_AFTER: (Duration, f32) = (Duration::from_secs(2), 0.1);

/// An estimate counts down until a new one differs from it by more than this share.
const ESTIMATE_TOLERANCE: f32 = 0.25;

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
        *step = Step::new(label, [from, to]);
    }

    /// The current step's name, and the estimated seconds until it is done.
    pub fn step_status(&self) -> (String, Option<u32>) {
        let mut step = self.step();
        let elapsed = step.start.elapsed();
        (step.label.clone(), step.seconds_left(self.fraction(), elapsed))
    }

    /// Ignores poisoning: the guarded value is only ever replaced as a whole.
    fn step(&self) -> MutexGuard<'_, Step> {
        self.step.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Step {
    fn new(label: &str, shares: [f32; 2]) -> Self {
        Self { label: label.into(), start: Instant::now(), shares, estimate: None }
    }

    /// Estimated seconds until the step is done, if after `elapsed` the whole job is done to the share `fraction`.
    fn seconds_left(&mut self, fraction: f32, elapsed: Duration) -> Option<u32> {
        let [from, to] = self.shares;
        let step_share = (fraction - from) / (to - from);
        if elapsed < ESTIMATE_AFTER.0 || step_share < ESTIMATE_AFTER.1 {
            return None;
        }
        let newest = elapsed.as_secs_f32() * (1.0 - step_share).max(0.0) / step_share;
        let counted_down = |(left, at): (f32, Duration)| left - elapsed.saturating_sub(at).as_secs_f32();
        let is_close = |left: &f32| (left - newest).abs() <= ESTIMATE_TOLERANCE * left.max(newest);
        let left = self.estimate.map(counted_down).filter(is_close).unwrap_or_else(|| {
            self.estimate = Some((newest, elapsed));
            newest
        });
        Some(left.ceil() as u32)
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
        *self.step() = Step::new(part.name, [part.from, part.to]);
        self.report(part.from);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use progress::Stage;

    #[test]
    fn an_estimate_counts_down_as_long_as_it_is_close() {
        let mut step = Step::new("", [0.0, 1.0]);
        let mut after =
            |seconds, fraction| step.seconds_left(fraction, Duration::from_secs(seconds)).unwrap();
        assert_eq!(after(10, 0.1), 90);
        assert_eq!(after(20, 0.22), 80, "counted down; the newest is 71");
        assert_eq!(after(30, 0.5), 30, "it was far off");
        assert_eq!(after(59, 0.98), 1);
    }

    #[test]
    fn the_remaining_time_follows_from_the_share_done() {
        let after = |seconds, fraction| {
            Step::new("", [0.5, 0.9]).seconds_left(fraction, Duration::from_secs(seconds))
        };
        assert_eq!(after(10, 0.6), Some(30), "a quarter in ten seconds");
        assert_eq!(after(10, 0.9), Some(0));
        assert_eq!(after(10, 0.53), None, "too little is done");
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
