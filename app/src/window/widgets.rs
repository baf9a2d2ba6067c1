//! What bars, panes, dialogs and tools share: controls, keys, the theme and the false colours of blur.

pub mod brush_controls;
pub mod controls;
pub mod false_colour;
pub mod focus_slider;
pub mod keys;
pub mod theme;
