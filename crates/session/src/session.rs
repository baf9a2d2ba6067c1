//! An open document and the work on it: commands in, events out.
//!
//! [`Session`] holds the state; each file beside it does one kind of work on that state, in the background where it takes
//! long. The window sees nothing below.

mod command_dispatch;
mod queries;
mod references;
mod picture_export;
mod files;
mod opening_preview;
mod scene_watching;
mod history;
mod job_outcome;
mod painting;
mod polling;
mod recovery;
mod stage_change;
mod stage_rebuild;
mod preview_updates;
mod state;
mod timeline;
mod verification;
mod watched_file;

pub use picture_export::FullSizeFieldState;
pub use state::{Session, SessionOptions};
