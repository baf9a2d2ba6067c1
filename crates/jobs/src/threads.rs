//! Threads of background work: their priority, and errors from panics.

use crate::error::JobError;
use std::panic::AssertUnwindSafe;

/// Stack size of a job's thread, and of Rayon's: import and unwrapping may recurse over a scene's hierarchy, and a thread of Rayon that
/// waits works on other tasks meanwhile, within its own.
pub(crate) const STACK_BYTES: usize = 16 << 20;

/// How soon work is needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Urgency {
    /// A person is waiting for it.
    Interactive,
    /// Whenever there is time: the pictures being painted on take precedence.
    Background,
}

/// By how much the niceness of threads of background work is raised.
#[cfg(target_os = "linux")]
const NICE_INCREMENT: i32 = 5;

impl Urgency {
    /// Sets the priority of the calling thread.
    #[cfg(target_os = "linux")]
    fn declare(self) {
        if self == Self::Background {
            // If this is not permitted, the thread keeps its priority.
            let _ = rustix::process::nice(NICE_INCREMENT);
        }
    }

    /// The same on Windows.
    #[cfg(windows)]
    #[allow(unsafe_code, reason = "the standard library has no priorities")]
    fn declare(self) {
        use windows_sys::Win32::System::Threading::{
            GetCurrentThread, SetThreadPriority, THREAD_PRIORITY_BELOW_NORMAL,
        };
        if self == Self::Background {
            // SAFETY: they take a handle that is always valid, and a number; on failure the thread keeps its priority.
            unsafe {
                SetThreadPriority(GetCurrentThread(), THREAD_PRIORITY_BELOW_NORMAL);
            }
        }
    }

    /// Other systems only let whole processes lower their priority.
    #[cfg(not(any(target_os = "linux", windows)))]
    fn declare(self) {}
}

/// Starts Rayon's global pool with so many `threads` (0: one for each processor, or RAYON_NUM_THREADS) and the stacks of the other pools.
///
/// # Errors
/// [`JobError::NoThread`]: it runs already, or the system refused a thread.
pub fn start_global_pool(threads: usize) -> Result<(), JobError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK_BYTES).build_global();
    pool.map_err(|error| no_thread(&error))
}

fn no_thread(error: &rayon::ThreadPoolBuildError) -> JobError {
    JobError::NoThread { task: "working".into(), reason: error.to_string() }
}

/// A Rayon pool for long work. In the global pool, work that the window needs at once would wait behind its long items; with separate
/// pools, the system divides the processors between them.
///
/// # Errors
/// [`JobError::NoThread`]: the system refused a thread.
pub fn build_thread_pool(urgency: Urgency) -> Result<rayon::ThreadPool, JobError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .stack_size(STACK_BYTES)
        .start_handler(move |_| urgency.declare())
        .build();
    pool.map_err(|error| no_thread(&error))
}

/// Runs `work` in a thread pool of its own.
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
pub fn catch_panics<T, E: From<JobError>>(task: &str, work: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
    std::panic::catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|payload| Err(JobError::from_panic(task, payload.as_ref()).into()))
}
