//! Background work: threads, progress, cancellation.
//!
//! This is the only crate below the window that starts threads and reads the clock. Code that may start work is passed a [`Background`]
//! and starts a [`SharedTask`] on it. A [`Job`] is work for the window, with a name, a progress bar and a result.
//!
//! ```
//! use jobs::{Background, CancelToken, SharedTask};
//! use std::sync::{Arc, OnceLock};
//!
//! let (task, result) = (Arc::new(SharedTask::new(CancelToken::default())), Arc::new(OnceLock::new()));
//! let slot = result.clone();
//! task.start(Background::Threads, "adding", move |_progress| {
//!     let _ = slot.set(6 * 7);
//! });
//! let sum = task.wait(&progress::Unwatched, || result.get().copied());
//! assert_eq!(sum, Ok(Some(42)));
//! ```

mod background;
mod cancel_token;
mod error;
mod job;
mod job_progress;
mod shared_task;
mod threads;

pub use background::Background;
pub use cancel_token::CancelToken;
pub use error::JobError;
pub use job::{Job, JobId, JobStatus, Waker};
pub use job_progress::JobProgress;
pub use shared_task::SharedTask;
pub use threads::{Urgency, build_thread_pool, catch_panics, run_in_own_pool, start_global_pool};
