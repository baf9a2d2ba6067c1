//! What each photograph shows of each texel.
//!
//! ```text
//! views ─▶ packed_picture ─┐
//!    └──▶ depth_map ───────┴▶ loading (one after the other, within the memory limit) ─▶ by_texel
//! ```

mod by_texel;
mod depth_map;
mod loading;
mod packed_picture;

pub(crate) use by_texel::{Observation, Observations, ViewVisibility, border_weight};
pub(crate) use loading::{LoadedView, ViewLoader};
pub(crate) use packed_picture::{PackedPicture, PictureSample};
