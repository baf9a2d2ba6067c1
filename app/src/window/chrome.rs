//! What surrounds the views: menus, bars, headers, command palette, help and toasts.

pub mod help;
pub mod menu_bar;
pub mod palette;
pub mod status_line;
pub mod toasts;
pub mod tool_column;
pub mod tool_options;
pub mod view_header;
