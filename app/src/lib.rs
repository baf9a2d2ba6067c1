//! Focus Brush: the window and the command line, both thin over the `session` crate.

pub mod cli;
pub mod window;
