//! Why background work failed.

/// Why background work failed, other than by an error of its own.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JobError {
    /// The system refused a thread.
    #[error("{task}: no thread could be started: {reason} (try again)")]
    NoThread {
        /// The task that was to run.
        task: String,
        /// The system's message.
        reason: String,
    },
    /// The work panicked: a fault of the program.
    #[error("{task}: stopped by a fault of the program: {message} (please report this)")]
    Panicked {
        /// The task that was running.
        task: String,
        /// The first line of the panic's message.
        message: String,
    },
}

/// How the messages of the standard library and of Rayon begin where they panic because the system refused a thread.
const NO_THREAD: [&str; 2] = ["failed to spawn thread", "The global thread pool has not been initialized"];

impl JobError {
    /// The error for a panic of `task` with this payload.
    pub(crate) fn from_panic(task: &str, payload: &(dyn std::any::Any + Send)) -> Self {
        let message = payload.downcast_ref::<&str>().copied();
        let message = message.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
        let message = message.unwrap_or("no message").lines().next().unwrap_or_default();
        let task = task.into();
        match NO_THREAD.iter().any(|start| message.starts_with(start)) {
            true => Self::NoThread { task, reason: message.into() },
            false => Self::Panicked { task, message: message.into() },
        }
    }
}
