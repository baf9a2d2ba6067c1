//! An edit in progress.

use crate::editing::active_gradient::ActiveGradient;
use crate::editing::painter::Painter;

/// An edit in progress, which is no undo step yet.
pub enum ActiveEdit {
    /// A stroke.
    Stroke(Box<Painter>),
    /// A gradient.
    Gradient(Box<ActiveGradient>),
}
