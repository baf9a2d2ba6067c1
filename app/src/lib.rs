//! Focus Brush: the window and the command line, both thin layers over the `session` crate.

pub mod cli;
pub mod window;
