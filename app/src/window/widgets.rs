//! What bars, panes, dialogs and tools share: controls, icons, keys, the theme and the false colours of blur.

pub mod brush_controls;
pub mod controls;
pub mod false_colour;
pub mod focus_slider;
pub mod focus_thumbnail;
pub mod icon;
pub mod keys;
pub mod ray_diagram;
pub mod rename_field;
pub mod theme;
