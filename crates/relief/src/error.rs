//! Errors of making a surface.

use progress::Cancelled;

/// Why there is no surface.
#[derive(Debug)]
pub enum ReliefError<E> {
    /// It was cancelled.
    Cancelled(Cancelled),
    /// A view cannot be read.
    View(E),
}
