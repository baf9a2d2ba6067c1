//! An open document and the work on it: commands in, events out.
//!
//! [`Session`] holds the state; each submodule implements one kind of work on it, in the background if it takes long.

mod command_dispatch;
mod export;
mod files;
mod history;
mod job_outcome;
mod memory;
mod opening_preview;
mod painting;
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

pub use export::FullSizeFieldState;
pub use memory::MemoryPart;
pub use state::{Session, SessionOptions};
