//! What is being painted and is no step of undo yet.

use super::gradient_in_hand::GradientInHand;
use super::painter::Painter;

/// What is being painted and is no step of undo yet.
pub(crate) enum Underway {
    /// A stroke.
    Stroke(Box<Painter>),
    /// A gradient.
    Gradient(Box<GradientInHand>),
}
