//! What of focus moves: values at times, and how one becomes the next.
//!
//! * [`Keys`]: values of anything at times, each with the [`Ease`] by which it becomes the next.
//! * [`LensMotion`]: where the lens focuses ([`FocusTarget`]: a distance, or a point of the surface that is followed) and its f-number.
//! * [`LayerMotion`]: how much a layer counts, as a whole and by depth.
//!
//! Whatever lies between two keys lies between their values: nothing swings beyond them.

mod keys;
mod layer_motion;
mod lens_motion;

pub use keys::{Ease, Key, KeySpan, Keys};
pub use layer_motion::LayerMotion;
pub use lens_motion::{FocusTarget, LensMotion};
