//! What is being painted and is no step of undo yet.

use super::gradient_in_hand::ActiveGradient;
use super::painter::Painter;

/// What is being painted and is no step of undo yet.
pub(crate) enum ActiveEdit {
    /// A stroke.
    Stroke(Box<Painter>),
    /// A gradient.
    Gradient(Box<ActiveGradient>),
}
