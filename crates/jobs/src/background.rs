//! Where work runs that goes on beside its caller.

/// Where work runs that goes on beside its caller: passed to whoever may start some, so that no library starts a thread by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    /// On a thread of its own.
    #[default]
    Threads,
    /// In its caller, which waits: for programs that must not start threads, and for tests that count what was done.
    Inline,
}

impl Background {
    /// Starts `work` on a thread called `name`, or does it at once. Returns whether it was started: the system may refuse a thread.
    pub(crate) fn start(self, name: &str, work: impl FnOnce() + Send + 'static) -> bool {
        match self {
            Self::Threads => std::thread::Builder::new().name(name.into()).spawn(work).is_ok(),
            Self::Inline => {
                work();
                true
            }
        }
    }
}
