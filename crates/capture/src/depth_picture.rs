//! Pictures with depth: one picture, and how far what it shows is.
//!
//! Either in one file (an EXR with a channel of depth, a JPEG with GDepth or Dynamic Depth in or behind it: `jpeg`, `xmp`, `gdepth`,
//! `dynamic_depth`) or in two (`beside`). `reading` finds out which, and turns both as the picture wants to be seen.

mod base64_text;
mod beside;
mod depth_range;
mod dynamic_depth;
mod embedded;
mod gdepth;
mod jpeg;
mod reading;
mod xmp;

pub use reading::{DepthContainer, DepthPicture, DepthPictureOptions, open_depth_picture};
pub(crate) use reading::{InFolder, has_depth, in_folder};
