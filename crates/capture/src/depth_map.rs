//! Depth and disparity maps: a number per pixel for the distance of what a picture shows.
//!
//! The stages for a map: `pfm`, `exr_depth`, `levels`, `raw_floats` (the numbers as they are stored) → `meaning` (what they mean: by the
//! caller, by the file's name, by [`NearEnd`]; never by guessing) → [`DepthMap`].

mod depth_file;
mod exr_depth;
mod levels;
mod map;
mod meaning;
mod near_end;
mod pfm;
mod raw_floats;
mod stored;

pub(crate) use depth_file::read_depth_channel;
pub use depth_file::read_depth_map;
pub(crate) use levels::{is_coded_by_color, levels_of};
pub use map::{DepthMap, DepthMeaning};
pub use meaning::DepthQuantity;
pub(crate) use meaning::quantity_from_name;
pub use near_end::NearEnd;
pub(crate) use raw_floats::raw_floats;
