//! An open document and the work on it: commands in, events out.
//!
//! [`Session`] holds the state; each submodule implements one kind of work on it, in the background if it takes long.

mod command_dispatch;
mod files;
mod history;
mod job_outcome;
mod memory;
mod opening_preview;
mod painting;
mod picture_export;
mod polling;
mod preview_updates;
mod queries;
mod recovery;
mod references;
mod scene_watching;
mod stage_change;
mod stage_rebuild;
mod state;
mod timeline;
mod verification;
mod watched_file;
mod web_page_export;

pub use memory::MemoryPart;
pub use picture_export::FullSizeFieldState;
pub use state::{Session, SessionOptions};
