//! The window.

mod false_colour;
mod paint_view;

use std::path::PathBuf;

/// What the window starts with.
#[derive(Clone, Debug, Default)]
pub struct WindowOptions {
    /// A scene or project to open; the demo when there is none.
    pub file: Option<PathBuf>,
}
