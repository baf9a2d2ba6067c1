//! Animation of the focus: keyframes and their interpolation.
//!
//! * [`Keys`]: keyframes of any value, each with the [`Ease`] that leads to the next.
//! * [`LensMotion`]: where the lens focuses ([`FocusTarget`]: a distance, or a surface point that is followed) and its f-number.
//! * [`LayerMotion`]: a layer's weight, as a whole and by depth.
//!
//! A value between two keys always lies between their values: nothing overshoots.

mod character_motion;
mod keys;
mod layer_motion;
mod lens_motion;

pub use keys::{Ease, Key, KeySpan, Keys};
pub use layer_motion::LayerMotion;
pub use lens_motion::{FocusTarget, KeyedCharacter, LensMotion};
