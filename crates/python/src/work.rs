//! Long work: on a thread of its own, while the calling thread waits without Python's lock, tells the callback and hears signals.
//!
//! No thread but the caller's ever touches Python, so other threads of the program run on.

use crate::errors::exception;
use crate::threads::check_process;
use light::Steps;
use progress::{Part, Progress};
use pyo3::prelude::*;
use render::RenderError;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How often the caller looks up from waiting. Ctrl-C is heard within this time, and the time the work takes to stop.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Stack size of the working thread, as on the command line: deeply nested scenes must not overflow it.
const STACK_BYTES: usize = 64 << 20;

/// Runs `work`, named `task` in messages, and tells `callback` its progress: the share that is done, in [0, 1], and the name of the step.
///
/// # Errors
/// Those of the work; what the callback raises, or the handler of a signal, once the work has stopped.
pub fn run<T: Send>(
    py: Python<'_>,
    task: &'static str,
    callback: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> Result<T, RenderError> + Send,
) -> PyResult<T> {
    check_process()?;
    // It runs already after the first call.
    let _ = jobs::start_global_pool(0);
    let watch = Watch::default();
    std::thread::scope(|scope| {
        let guarded = || {
            let outcome = jobs::catch_panics(task, || work(&watch));
            watch.finish();
            outcome
        };
        let builder = std::thread::Builder::new().name("focus-brush".into()).stack_size(STACK_BYTES);
        let thread = builder.spawn_scoped(scope, guarded).map_err(|error| {
            exception(RenderError::TryAgain(format!("no thread could be started: {error} (try again)")))
        })?;
        let interruption = watch_over(py, &watch, callback);
        if interruption.is_err() {
            watch.is_cancelled.store(true, Ordering::Relaxed);
        }
        let outcome = py.detach(|| thread.join());
        interruption?;
        let lost = || RenderError::Internal(format!("{task}: ended without a result (please report this)"));
        outcome.unwrap_or_else(|_| Err(lost())).map_err(exception)
    })
}

/// Returns once the work is done.
fn watch_over(py: Python<'_>, watch: &Watch, callback: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
    let mut reported = Step::default();
    loop {
        let (step, is_done) = py.detach(|| watch.wait());
        py.check_signals()?;
        if let Some(callback) = callback.filter(|_| step != reported) {
            callback.call1((step.share, &step.name))?;
            reported = step;
        }
        if is_done {
            return Ok(());
        }
    }
}

/// What the working thread reports and the caller reads.
#[derive(Default)]
pub struct Watch {
    is_cancelled: AtomicBool,
    step: Mutex<Step>,
    is_done: Mutex<bool>,
    done: Condvar,
}

/// How far the work is.
#[derive(Clone, Default, PartialEq)]
struct Step {
    /// The share of the step that is done, in [0, 1].
    share: f32,
    /// What is being done.
    name: String,
}

impl Watch {
    /// Waits a while for the end of the work.
    fn wait(&self) -> (Step, bool) {
        let is_done = lock(&self.is_done);
        let waited = self.done.wait_timeout_while(is_done, POLL_INTERVAL, |is_done| !*is_done);
        let is_done = *waited.unwrap_or_else(PoisonError::into_inner).0;
        (lock(&self.step).clone(), is_done)
    }

    fn finish(&self) {
        *lock(&self.is_done) = true;
        self.done.notify_all();
    }
}

/// The values behind these locks are complete whenever a thread can panic.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Steps for Watch {
    fn begin(&self, label: &str) -> Box<dyn Progress + '_> {
        *lock(&self.step) = Step { share: 0.0, name: label.into() };
        Box::new(WatchedStep(self))
    }
}

/// A step of the work.
struct WatchedStep<'a>(&'a Watch);

impl Progress for WatchedStep<'_> {
    fn report(&self, fraction: f32) {
        let mut step = lock(&self.0.step);
        step.share = step.share.max(fraction.clamp(0.0, 1.0));
    }

    fn cancelled(&self) -> bool {
        self.0.is_cancelled.load(Ordering::Relaxed)
    }

    fn begin_part(&self, part: &Part) {
        lock(&self.0.step).name = part.name.into();
    }
}
