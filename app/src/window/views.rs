//! The panes of the window: paint view, picture view, inspector and drawer.

pub mod aperture_orbit;
mod brush_hud;
pub mod drawer;
pub mod inspector;
pub mod paint_view;
pub mod picture_view;
