//! Focus Brush: the window, a thin layer over the `session` crate, and the command line, one over `render`.
//!
//! [`cli::run`] is the whole program: it parses the arguments of the process and opens the window
//! ([`window::run`]) or runs a subcommand. [`window::Shell`] is the application; [`window::ViewSettings`] and
//! [`window::Layout`] are what it stores between runs:
//!
//! ```
//! use focus_brush::window::ViewSettings;
//!
//! let stored = serde_json::to_string(&ViewSettings { scale: 1.5, ..ViewSettings::default() })?;
//! let settings: ViewSettings = serde_json::from_str(&stored)?;
//! assert_eq!(settings.scale, 1.5);
//! # Ok::<(), serde_json::Error>(())
//! ```

pub mod cli;
pub mod heap;
pub mod window;
