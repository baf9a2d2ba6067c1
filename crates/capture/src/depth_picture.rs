//! Pictures with depth: one picture, and the distance of what it shows.
//!
//! Either in one file (an EXR with a depth channel, a JPEG with GDepth or Dynamic Depth in or behind it: `jpeg`, `xmp`, `gdepth`,
//! `dynamic_depth`) or in two (`sibling_depth`). `reading` detects which, and orients both upright.

mod base64_text;
mod depth_range;
mod dynamic_depth;
mod embedded;
mod gdepth;
mod jpeg;
mod reading;
mod sibling_depth;
mod xmp;

pub use reading::{DepthContainer, DepthPicture, DepthPictureOptions, open_depth_picture};
pub(crate) use reading::{InFolder, has_depth, in_folder};
