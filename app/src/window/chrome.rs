//! What surrounds the views: menus, bars, command palette, help, toasts, theme and the controls they share.

pub mod controls;
pub mod focus_slider;
pub mod help;
pub mod keys;
pub mod menu_bar;
pub mod palette;
pub mod status_line;
pub mod theme;
pub mod toasts;
pub mod tool_bar;
pub mod view_header;
