//! Which photograph sees what.
//!
//! ```text
//! views ─▶ kept_picture ─┐
//!    └──▶ depth_picture ─┴▶ reading (one after the other, within the memory there is) ─▶ sightings
//! ```

mod depth_picture;
mod kept_picture;
mod reading;
mod sightings;

pub(crate) use kept_picture::{PackedPicture, PictureSample};
pub(crate) use reading::{LoadedView, ViewLoader};
pub(crate) use sightings::{Observation, Observations, ViewVisibility, border_weight};
