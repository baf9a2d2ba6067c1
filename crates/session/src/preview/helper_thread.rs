//! Threads for the long work of the preview.

use crate::error::SessionError;
use std::thread::{Builder, JoinHandle};

/// Bytes of a thread's stack: bakes and hierarchies recurse.
pub(super) const STACK_BYTES: usize = 16 << 20;

/// Starts a thread.
///
/// # Errors
/// The system refused it.
pub(super) fn spawn(
    name: &str,
    work: impl FnOnce() + Send + 'static,
) -> Result<JoinHandle<()>, SessionError> {
    let thread = Builder::new().name(name.into()).stack_size(STACK_BYTES).spawn(work);
    thread.map_err(|error| SessionError::TryAgain(format!("no thread: {error} (try again)")))
}
