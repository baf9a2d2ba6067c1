//! Background work: a named thread with progress, cancel and a result; its panics become errors.

use crate::SessionError;
use progress::Progress;
use std::panic::AssertUnwindSafe;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Names one piece of background work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JobId(pub u64);

/// How background work stands, for the status line.
#[derive(Clone, Debug, PartialEq)]
pub struct JobStatus {
    /// Which.
    pub id: JobId,
    /// What it does: "opening house.glb".
    pub label: String,
    /// Which step of it goes on: "unwrapping"; empty where it has but one.
    pub step: String,
    /// The share done, in [0, 1].
    pub fraction: f32,
    /// Seconds until the step is done, as far as can be told from how long the share that is done has taken.
    pub seconds_left: Option<u32>,
    /// Whether [`crate::Command::Cancel`] can stop it.
    pub can_cancel: bool,
}

/// Progress and cancellation shared between a job and its watchers.
pub struct JobProgress {
    fraction: AtomicU32,
    cancelled: AtomicBool,
    step: Mutex<Step>,
}

/// A part of a job.
struct Step {
    label: String,
    begun: Instant,
    /// Shares of the whole, before and after it.
    shares: [f32; 2],
}

impl Default for Step {
    fn default() -> Self {
        Self { label: String::new(), begun: Instant::now(), shares: [0.0, 1.0] }
    }
}

impl Default for JobProgress {
    fn default() -> Self {
        Self { fraction: AtomicU32::new(0), cancelled: AtomicBool::new(false), step: Mutex::default() }
    }
}

/// Before a step has gone on for this long, and is done to this share, nobody can tell how long it takes.
const KNOWN_AFTER: (Duration, f32) = (Duration::from_secs(1), 0.02);

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
    pub(crate) fn reset(&self) {
        self.cancelled.store(false, Ordering::Relaxed);
        self.begin_step("", 0.0, 1.0);
    }

    /// A part begins that takes the bar from one share of the whole to another.
    pub(crate) fn begin_step(&self, label: &str, from: f32, to: f32) {
        let mut step = self.step();
        self.fraction.store(from.to_bits(), Ordering::Relaxed);
        *step = Step { label: label.into(), begun: Instant::now(), shares: [from, to] };
    }

    /// What the part that goes on is called, and how many seconds it will take.
    pub(crate) fn standing(&self) -> (String, Option<u32>) {
        let step = self.step();
        (step.label.clone(), step.seconds_left(self.fraction(), step.begun.elapsed()))
    }

    /// A poisoned lock only means that a panic passed by: what it guards is replaced as a whole.
    fn step(&self) -> MutexGuard<'_, Step> {
        self.step.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Step {
    /// Seconds that it will take when it has come to this share of the whole in this time.
    fn seconds_left(&self, fraction: f32, elapsed: Duration) -> Option<u32> {
        let [from, to] = self.shares;
        let done = (fraction - from) / (to - from);
        let is_known = elapsed >= KNOWN_AFTER.0 && done >= KNOWN_AFTER.1;
        is_known.then(|| (elapsed.as_secs_f32() * (1.0 - done).max(0.0) / done).ceil() as u32)
    }
}

impl Progress for JobProgress {
    fn report(&self, fraction: f32) {
        self.fraction.fetch_max(fraction.clamp(0.0, 1.0).to_bits(), Ordering::Relaxed);
    }
    fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

/// Calls the window back when there is something to [`crate::Session::poll`].
pub type Waker = Arc<dyn Fn() + Send + Sync>;

/// Work in the background.
pub(crate) struct Job {
    pub id: JobId,
    pub label: String,
    pub progress: Arc<JobProgress>,
}

/// Stack of a job's thread: imports and unwrapping may recurse over a scene's hierarchy.
const STACK_BYTES: usize = 16 << 20;

impl Job {
    /// Starts `work` on a thread of its own and hands its result, or what its panic means, to `deliver`.
    pub fn start<T: Send + 'static>(
        id: JobId,
        label: String,
        work: impl FnOnce(&JobProgress) -> Result<T, SessionError> + Send + 'static,
        deliver: impl FnOnce(JobId, Result<T, SessionError>) + Send + 'static,
    ) -> Result<Self, SessionError> {
        let progress = Arc::new(JobProgress::default());
        let (shared, doing) = (progress.clone(), label.clone());
        std::thread::Builder::new()
            .name(label.clone())
            .stack_size(STACK_BYTES)
            .spawn(move || deliver(id, guarded(&doing, || among_others(Urgency::Later, || work(&shared)))))
            .map_err(|e| {
                SessionError::TryAgain(format!("{label}: no thread could be started: {e} (try again)"))
            })?;
        Ok(Self { id, label, progress })
    }

    pub fn status(&self) -> JobStatus {
        let (step, seconds_left) = self.progress.standing();
        JobStatus {
            id: self.id,
            label: self.label.clone(),
            step,
            fraction: self.progress.fraction(),
            seconds_left,
            can_cancel: !self.progress.cancelled(),
        }
    }
}

/// How soon work is needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Urgency {
    /// Somebody looks on.
    Now,
    /// When there is time: it stands back behind the pictures that one paints on.
    Later,
}

/// By how much the threads of work that has time stand back.
#[cfg(target_os = "linux")]
const STANDS_BACK: i32 = 5;

impl Urgency {
    /// Says so to the system, for the thread that calls.
    #[cfg(target_os = "linux")]
    fn declare(self) {
        if self == Self::Later {
            // Where that is not allowed, it does not stand back.
            let _ = rustix::process::nice(STANDS_BACK);
        }
    }

    /// Elsewhere only whole processes have a say.
    #[cfg(not(target_os = "linux"))]
    fn declare(self) {}
}

/// Rayon threads for work that takes its time: in the common ones, what the window needs at once would wait for its long
/// pieces. The system shares the processors out.
pub(crate) fn own_threads(urgency: Urgency) -> Result<rayon::ThreadPool, SessionError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .stack_size(STACK_BYTES)
        .start_handler(move |_| urgency.declare())
        .build();
    pool.map_err(|e| SessionError::TryAgain(format!("no threads could be started: {e} (try again)")))
}

/// Runs `work` with threads of its own.
pub(crate) fn among_others<T: Send>(
    urgency: Urgency,
    work: impl FnOnce() -> Result<T, SessionError> + Send,
) -> Result<T, SessionError> {
    own_threads(urgency)?.install(work)
}

/// Runs `work`; a panic in it becomes an error.
pub fn guarded<T>(doing: &str, work: impl FnOnce() -> Result<T, SessionError>) -> Result<T, SessionError> {
    std::panic::catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|payload| Err(SessionError::panicked(doing, payload.as_ref())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    #[test]
    fn what_is_left_follows_from_what_is_done() {
        let step = Step { shares: [0.5, 0.9], ..Step::default() };
        let after = |seconds, fraction| step.seconds_left(fraction, Duration::from_secs(seconds));
        assert_eq!(after(10, 0.6), Some(30), "a quarter in ten seconds");
        assert_eq!(after(10, 0.9), Some(0));
        assert_eq!(after(10, 0.5), None, "nothing is done");
        assert_eq!(after(0, 0.6), None, "it has just begun");
        let progress = JobProgress::default();
        progress.report(0.7);
        progress.begin_step("baking", 0.5, 0.9);
        assert_eq!((progress.standing().0.as_str(), progress.fraction()), ("baking", 0.5));
        progress.report(0.4);
        assert_eq!(progress.fraction(), 0.5, "it never runs back");
    }

    #[test]
    fn a_panic_is_an_error_and_a_result_arrives() {
        let (send, receive) = mpsc::channel();
        let deliver = send.clone();
        let panics = |_: &JobProgress| -> Result<u8, SessionError> { panic!("index out of bounds") };
        Job::start(JobId(1), "testing".into(), panics, move |id, r| deliver.send((id, r)).unwrap()).unwrap();
        let (id, result) = receive.recv_timeout(Duration::from_secs(10)).unwrap();
        assert_eq!(id, JobId(1));
        assert!(matches!(result, Err(SessionError::Internal(text)) if text.contains("index out of bounds")));

        Job::start(JobId(2), "testing".into(), |_| Ok(7), move |id, r| send.send((id, r)).unwrap()).unwrap();
        assert_eq!(receive.recv_timeout(Duration::from_secs(10)).unwrap(), (JobId(2), Ok(7)));
    }

    #[test]
    fn what_is_quick_does_not_wait_for_long_work() {
        use rayon::prelude::*;
        let (send, receive) = mpsc::channel();
        let (begun, has_begun) = mpsc::channel();
        let everybody = 4 * rayon::current_num_threads();
        let job = Job::start(
            JobId(1),
            "working".into(),
            move |progress| {
                // More pieces than threads, none of which ends by itself.
                (0..everybody).into_par_iter().for_each(|_| {
                    begun.send(()).unwrap();
                    while !progress.cancelled() {
                        std::thread::sleep(Duration::from_millis(1));
                    }
                });
                Ok(())
            },
            move |_, result: Result<(), _>| send.send(result).unwrap(),
        )
        .unwrap();
        has_begun.recv_timeout(Duration::from_secs(10)).unwrap();
        let quick: u32 = (0..1000u32).into_par_iter().sum();
        assert_eq!(quick, 499_500);
        assert!(receive.try_recv().is_err(), "the long work goes on");
        job.progress.cancel();
        assert_eq!(receive.recv_timeout(Duration::from_secs(10)).unwrap(), Ok(()));
    }

    #[test]
    fn cancel_reaches_the_work() {
        let (send, receive) = mpsc::channel();
        let job = Job::start(
            JobId(1),
            "waiting".into(),
            |progress| loop {
                progress.check()?;
                std::thread::sleep(Duration::from_millis(1));
            },
            move |_, r: Result<(), _>| send.send(r).unwrap(),
        )
        .unwrap();
        job.progress.cancel();
        assert_eq!(receive.recv_timeout(Duration::from_secs(10)).unwrap(), Err(SessionError::Cancelled));
    }
}
