//! Work that several callers can wait for, and that continues when any of them stops waiting.

use crate::background::Background;
use crate::cancel_token::CancelToken;
use progress::{Cancelled, Part, Progress};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How often a waiting caller checks for the result.
const POLL_INTERVAL: Duration = Duration::from_millis(5);

/// Work that several callers can wait for. It continues when any of them stops waiting, until its [`CancelToken`] is cancelled.
pub struct SharedTask {
    /// The share done in [0, 1], as the bits of an `f32`.
    fraction: AtomicU32,
    /// The current part of the work.
    part: Mutex<Option<Part>>,
    has_ended: AtomicBool,
    cancel: CancelToken,
}

impl SharedTask {
    /// A task that has not begun and is stopped by `cancel`.
    pub fn new(cancel: CancelToken) -> Self {
        Self {
            fraction: AtomicU32::new(0),
            part: Mutex::new(None),
            has_ended: AtomicBool::new(false),
            cancel,
        }
    }

    /// Starts the work, which stores its result where the `poll` function of [`Self::wait`] can read it. If the work panics, or no thread
    /// can be started, callers that wait receive `None`.
    pub fn start(
        self: &Arc<Self>,
        background: Background,
        name: &str,
        work: impl FnOnce(&dyn Progress) + Send + 'static,
    ) {
        let task = self.clone();
        let run = move || {
            let _ = catch_unwind(AssertUnwindSafe(|| work(&*task)));
            task.has_ended.store(true, Ordering::Release);
        };
        if !background.start(name, run) {
            self.has_ended.store(true, Ordering::Release);
        }
    }

    /// Waits until `poll` returns a value, and returns it; `None` if the work ended without one. The work's progress is passed on to
    /// `progress`.
    ///
    /// # Errors
    /// `progress` was cancelled while waiting. The work continues.
    pub fn wait<T>(
        &self,
        progress: &dyn Progress,
        poll: impl Fn() -> Option<T>,
    ) -> Result<Option<T>, Cancelled> {
        let mut reported_part = None;
        loop {
            // Read before polling: a result stored before the end is then visible to `poll`.
            let has_ended = self.has_ended.load(Ordering::Acquire);
            if let Some(result) = poll() {
                return Ok(Some(result));
            }
            if has_ended {
                return Ok(None);
            }
            progress.check()?;
            let part = *self.part();
            if let Some(part) = part.filter(|_| part != reported_part) {
                progress.begin_part(&part);
                reported_part = Some(part);
            }
            progress.report(f32::from_bits(self.fraction.load(Ordering::Relaxed)));
            std::thread::sleep(POLL_INTERVAL);
        }
    }

    /// Ignores poisoning: the guarded value is only ever replaced as a whole.
    fn part(&self) -> MutexGuard<'_, Option<Part>> {
        self.part.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for SharedTask {
    fn report(&self, fraction: f32) {
        self.fraction.fetch_max(fraction.to_bits(), Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.cancel.is_cancelled()
    }

    fn begin_part(&self, part: &Part) {
        *self.part() = Some(*part);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use progress::Unwatched;
    use std::sync::OnceLock;

    #[test]
    fn work_goes_on_until_it_is_cancelled() {
        let cancel = CancelToken::default();
        let task = Arc::new(SharedTask::new(cancel.clone()));
        let stopped = Arc::new(OnceLock::new());
        let slot = stopped.clone();
        task.start(Background::Threads, "waiting", move |progress| {
            while !progress.cancelled() {
                std::thread::sleep(Duration::from_millis(1));
            }
            let _ = slot.set(());
        });
        struct Impatient;
        impl Progress for Impatient {
            fn report(&self, _fraction: f32) {}
            fn cancelled(&self) -> bool {
                true
            }
        }
        assert!(task.wait(&Impatient, || stopped.get().copied()).is_err(), "nobody waits any more");
        assert!(stopped.get().is_none(), "but it goes on");
        cancel.cancel();
        assert_eq!(task.wait(&Unwatched, || stopped.get().copied()), Ok(Some(())));
    }

    #[test]
    fn a_panic_ends_the_wait_and_inline_work_is_done_at_once() {
        let task = Arc::new(SharedTask::new(CancelToken::default()));
        task.start(Background::Threads, "panicking", |_| panic!("for a test"));
        assert_eq!(task.wait(&Unwatched, || None::<u8>), Ok(None));
        let (task, result) = (Arc::new(SharedTask::new(CancelToken::default())), Arc::new(OnceLock::new()));
        let slot = result.clone();
        task.start(Background::Inline, "inline", move |_| slot.set(7).unwrap());
        assert_eq!(result.get(), Some(&7));
    }
}
