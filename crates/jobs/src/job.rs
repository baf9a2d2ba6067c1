//! Background work: a named thread with progress, cancellation and a result. Panics become errors.

use crate::error::JobError;
use crate::job_progress::JobProgress;
use crate::threads::{STACK_BYTES, Urgency, catch_panics, run_in_own_pool};
use progress::Progress;
use std::sync::Arc;

/// Identifies one job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JobId(pub u64);

/// The state of a job, for the status line.
#[derive(Clone, Debug, PartialEq)]
pub struct JobStatus {
    /// The job.
    pub id: JobId,
    /// What it does, such as "opening house.glb".
    pub label: String,
    /// The current step, such as "unwrapping"; empty if the job has only one.
    pub step: String,
    /// The share done, in [0, 1].
    pub fraction: f32,
    /// Estimated seconds until the step is done, from the time that its finished share has taken; `None` until there is an estimate.
    pub seconds_left: Option<u32>,
    /// Whether it can still be cancelled.
    pub can_cancel: bool,
}

/// Wakes the window when there is something to poll.
pub type Waker = Arc<dyn Fn() + Send + Sync>;

/// A running job.
pub struct Job {
    /// Identifies it.
    pub id: JobId,
    /// What it does.
    pub label: String,
    /// Its progress, through which it is also cancelled.
    pub progress: Arc<JobProgress>,
}

impl Job {
    /// Starts `work` on a thread of its own and passes its result to `deliver`; a panic becomes [`JobError::Panicked`].
    ///
    /// # Errors
    /// [`JobError::NoThread`]: the system refused a thread.
    pub fn start<T: Send + 'static, E: From<JobError> + Send + 'static>(
        id: JobId,
        label: String,
        work: impl FnOnce(&JobProgress) -> Result<T, E> + Send + 'static,
        deliver: impl FnOnce(JobId, Result<T, E>) + Send + 'static,
    ) -> Result<Self, JobError> {
        let progress = Arc::new(JobProgress::default());
        let (shared, task) = (progress.clone(), label.clone());
        std::thread::Builder::new()
            .name(label.clone())
            .stack_size(STACK_BYTES)
            .spawn(move || {
                deliver(id, catch_panics(&task, || run_in_own_pool(Urgency::Background, || work(&shared))));
            })
            .map_err(|error| JobError::NoThread { task: label.clone(), reason: error.to_string() })?;
        Ok(Self { id, label, progress })
    }

    /// Its current state.
    pub fn status(&self) -> JobStatus {
        let (step, seconds_left) = self.progress.step_status();
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

#[cfg(test)]
mod tests {
    use super::*;
    use progress::Cancelled;
    use std::sync::mpsc;
    use std::time::Duration;

    #[derive(Debug, PartialEq)]
    enum TestError {
        Cancelled,
        Job(JobError),
    }

    impl From<Cancelled> for TestError {
        fn from(_: Cancelled) -> Self {
            Self::Cancelled
        }
    }

    impl From<JobError> for TestError {
        fn from(error: JobError) -> Self {
            Self::Job(error)
        }
    }

    /// Longer than any machine takes.
    const PATIENCE: Duration = Duration::from_secs(120);

    #[test]
    fn a_panic_is_an_error_and_a_result_arrives() {
        let (send, receive) = mpsc::channel();
        let deliver = send.clone();
        let panics = |_: &JobProgress| -> Result<u8, TestError> { panic!("index out of bounds") };
        Job::start(JobId(1), "testing".into(), panics, move |id, r| deliver.send((id, r)).unwrap()).unwrap();
        let (id, result) = receive.recv_timeout(PATIENCE).unwrap();
        assert_eq!(id, JobId(1));
        assert!(
            matches!(result, Err(TestError::Job(JobError::Panicked { message, .. })) if message.contains("index out of bounds"))
        );

        Job::start(JobId(2), "testing".into(), |_| Ok(7), move |id, r| send.send((id, r)).unwrap()).unwrap();
        assert_eq!(receive.recv_timeout(PATIENCE).unwrap(), (JobId(2), Ok(7)));
    }

    #[test]
    fn quick_work_does_not_wait_for_long_work() {
        use rayon::prelude::*;
        let (send, receive) = mpsc::channel();
        let (begun, has_begun) = mpsc::channel();
        let everybody = 4 * rayon::current_num_threads();
        let job = Job::start(
            JobId(1),
            "working".into(),
            move |progress| {
                // More items than threads, none of which ends by itself.
                (0..everybody).into_par_iter().for_each(|_| {
                    begun.send(()).unwrap();
                    while !progress.cancelled() {
                        std::thread::sleep(Duration::from_millis(1));
                    }
                });
                Ok(())
            },
            move |_, result: Result<(), TestError>| send.send(result).unwrap(),
        )
        .unwrap();
        has_begun.recv_timeout(PATIENCE).unwrap();
        let quick: u32 = (0..1000u32).into_par_iter().sum();
        assert_eq!(quick, 499_500);
        assert!(receive.try_recv().is_err(), "the long work goes on");
        job.progress.cancel();
        assert_eq!(receive.recv_timeout(PATIENCE).unwrap(), Ok(()));
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
            move |_, r: Result<(), TestError>| send.send(r).unwrap(),
        )
        .unwrap();
        job.progress.cancel();
        assert_eq!(receive.recv_timeout(PATIENCE).unwrap(), Err(TestError::Cancelled));
    }
}
