//! Why work in the background came to nothing.

/// Why work in the background came to nothing, apart from errors of its own.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JobError {
    /// The system gave no thread for it.
    #[error("{task}: no thread could be started: {reason} (try again)")]
    NoThread {
        /// What was to be done.
        task: String,
        /// What the system says.
        reason: String,
    },
    /// It panicked: a fault of the program.
    #[error("{task}: stopped by a fault of the program: {message} (please report this)")]
    Panicked {
        /// What was being done.
        task: String,
        /// What the panic says.
        message: String,
    },
}

impl JobError {
    /// What a panic of `task` means, by its payload.
    pub(crate) fn from_panic(task: &str, payload: &(dyn std::any::Any + Send)) -> Self {
        let message = payload.downcast_ref::<&str>().copied();
        let message = message.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
        let message = message.unwrap_or("no message").lines().next().unwrap_or_default();
        Self::Panicked { task: task.into(), message: message.into() }
    }
}
