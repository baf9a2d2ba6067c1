//! Animated documents: which frames to render, what each looks like, and rendering them one after another.
//!
//! ```text
//! FrameList, Shard ─▶ which frames        Take: scene, camera and focus at a time ─▶ plan (hash of all inputs of a frame)
//!                          └──────────▶ render_frames ◀──────────┘
//!                                            │ skips frames that are finished by that plan; bakes only what moved (FrameBaker)
//!                                            ▼
//!                                       FrameFiles
//! ```
//!
//! A frame depends on the document and its own time, never on which other frames are rendered. Any subset, in any order, on any
//! machine, therefore gives the same bytes.

mod baker;
mod frame_files;
mod frame_list;
mod outcome;
mod plan;
mod run;
mod scene_in_time;
mod shard;
mod take;

pub use baker::Baking;
pub use frame_files::FrameFiles;
pub use frame_list::FrameList;
pub use outcome::Outcome;
pub(crate) use plan::still_frame_plan;
pub use run::{FrameReport, SequenceOptions, SequenceReport, render_frames};
pub use shard::Shard;
pub use take::{Take, TakeOptions};
