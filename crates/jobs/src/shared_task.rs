//! Work that several callers wait for, and that goes on whoever stops waiting.

use crate::background::Background;
use crate::cancel_token::CancelToken;
use progress::{Cancelled, Part, Progress};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How often a waiting caller looks whether the result is there.
const POLL_INTERVAL: Duration = Duration::from_millis(5);

/// Work that several callers wait for. It goes on whoever stops waiting, until its [`CancelToken`] is cancelled.
pub struct SharedTask {
    /// The share done: bits of an f32.
    fraction: AtomicU32,
    /// The part of the work that goes on.
    part: Mutex<Option<Part>>,
    has_ended: AtomicBool,
    cancel: CancelToken,
}

impl SharedTask {
    /// Work that has not begun, which `cancel` stops.
    pub fn new(cancel: CancelToken) -> Self {
        Self { fraction: AtomicU32::new(0), part: Mutex::new(None), has_ended: AtomicBool::new(false), cancel }
    }

    /// Starts the work. Its result is stored by the work itself, where the `poll` of [`Self::wait`] finds it. A panic ends it like
    /// anything else: whoever waits finds nothing.
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

    /// What `poll` returns as soon as it returns something; `None` if the work ended without. Progress of the work is passed on to
    /// `progress`.
    ///
    /// # Errors
    /// `progress` says to stop waiting. The work goes on.
    pub fn wait<T>(
        &self,
        progress: &dyn Progress,
        poll: impl Fn() -> Option<T>,
    ) -> Result<Option<T>, Cancelled> {
        let mut reported_part = None;
        loop {
            // Read first: a result that was stored before the end is there by then.
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

    /// A poisoned lock only means that a panic passed by: what it guards is replaced as a whole.
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
