//! What is being painted and is no step of undo yet.

use crate::editing::active_gradient::ActiveGradient;
use crate::editing::painter::Painter;

/// What is being painted and is no step of undo yet.
pub enum ActiveEdit {
    /// A stroke.
    Stroke(Box<Painter>),
    /// A gradient.
    Gradient(Box<ActiveGradient>),
}
