//! Threads of background work: how soon it is needed, and what its panics mean.

use crate::error::JobError;
use std::panic::AssertUnwindSafe;

/// Stack of a job's thread: imports and unwrapping may recurse over a scene's hierarchy.
pub(crate) const STACK_BYTES: usize = 16 << 20;

/// How soon work is needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Urgency {
    /// Somebody looks on.
    Interactive,
    /// When there is time: it stands back behind the pictures that one paints on.
    Background,
}

/// By how much the threads of work that has time stand back.
#[cfg(target_os = "linux")]
const NICE_INCREMENT: i32 = 5;

impl Urgency {
    /// Says so to the system, for the thread that calls.
    #[cfg(target_os = "linux")]
    fn declare(self) {
        if self == Self::Background {
            // Where that is not allowed, it does not stand back.
            let _ = rustix::process::nice(NICE_INCREMENT);
        }
    }

    /// Elsewhere only whole processes have a say.
    #[cfg(not(target_os = "linux"))]
    fn declare(self) {}
}

/// Rayon threads for work that takes its time: in the common ones, what the window needs at once would wait for its long
/// pieces. The system shares the processors out.
///
/// # Errors
/// [`JobError::NoThread`]: the system gave none.
pub fn build_thread_pool(urgency: Urgency) -> Result<rayon::ThreadPool, JobError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .stack_size(STACK_BYTES)
        .start_handler(move |_| urgency.declare())
        .build();
    pool.map_err(|error| JobError::NoThread { task: "working".into(), reason: error.to_string() })
}

/// Runs `work` with threads of its own.
///
/// # Errors
/// Those of `work`, and [`JobError::NoThread`].
pub fn run_in_own_pool<T: Send, E: From<JobError> + Send>(
    urgency: Urgency,
    work: impl FnOnce() -> Result<T, E> + Send,
) -> Result<T, E> {
    build_thread_pool(urgency)?.install(work)
}

/// Runs `work`; a panic in it becomes an error that names the `task`.
///
/// # Errors
/// Those of `work`, and [`JobError::Panicked`].
pub fn catch_panics<T, E: From<JobError>>(
    task: &str,
    work: impl FnOnce() -> Result<T, E>,
) -> Result<T, E> {
    std::panic::catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|payload| Err(JobError::from_panic(task, payload.as_ref()).into()))
}
