//! Work in the background.
//!
//! A [`Job`] is a named thread with progress, cancel and a result; [`Steps`] are how long work tells its parts. Which threads
//! stand back behind which is decided here.

mod job;
mod job_progress;
mod steps;
mod threads;

pub use job::{JobId, JobStatus, Waker};
pub use job_progress::JobProgress;
pub use steps::Steps;
pub use threads::catch_panics;

pub(crate) use job::Job;
pub(crate) use steps::JobSteps;
pub(crate) use threads::{Urgency, build_thread_pool, run_in_own_pool};
