//! Where background work runs.

use crate::threads::{Urgency, build_thread_pool};

/// Where background work runs. It is passed to everything that may start some, so that no library starts a thread of its own accord.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    /// Each task on a thread and in a thread pool of its own, of low priority.
    #[default]
    Threads,
    /// On the caller's thread, before the call returns: for programs that must not start threads, and for tests that count what was done.
    Inline,
}

impl Background {
    /// Starts `work` on a thread named `name`, or runs it at once. Returns whether it was started: the system may refuse a thread.
    pub(crate) fn start(self, name: &str, work: impl FnOnce() + Send + 'static) -> bool {
        match self {
            Self::Threads => build_thread_pool(Urgency::Background).is_ok_and(|pool| {
                std::thread::Builder::new().name(name.into()).spawn(move || pool.install(work)).is_ok()
            }),
            Self::Inline => {
                work();
                true
            }
        }
    }
}
