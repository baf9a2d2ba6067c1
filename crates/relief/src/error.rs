//! What can keep a surface from being made.

use progress::Cancelled;

/// Why there is no surface.
#[derive(Debug)]
pub enum ReliefError<E> {
    /// It was cancelled.
    Cancelled(Cancelled),
    /// A view cannot be read.
    View(E),
}
