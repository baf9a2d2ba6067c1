//! A document in time: which frames, what each of them looks like, and rendering them one after the other.
//!
//! ```text
//! FrameList, Shard ─▶ which frames        Take: scene, camera and focus at a time ─▶ plan (what the frame's bytes depend on)
//!                          └──────────▶ render_frames ◀──────────┘
//!                                            │ skips what is finished by that plan; bakes what moved (FrameBaker)
//!                                            ▼
//!                                       FrameFiles
//! ```
//!
//! A frame depends on the document and its own time, never on which other frames are rendered: any share of them, in any order, on
//! any machine, gives the same bytes.

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
pub use run::{FrameReport, SequenceOptions, SequenceReport, WritePicture, render_frames};
pub use shard::Shard;
pub use take::{Take, TakeOptions};
