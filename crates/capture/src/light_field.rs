//! Light fields: pictures of one place from many points of an aperture.
//!
//! The road of a light field: `finding` (whose names the files have) → `row_column`, `hexagon`, `view_list` (each to an `Arrangement`: file and place
//! of every view), or a [`crate::Mosaic`] → `reading` (sizes, what is missing, `optics`, `disparity`) → `parallax` (whether
//! rows or columns run as their names say).

mod arrangement;
mod attributes;
mod disparity;
mod finding;
mod hexagon;
mod light_field_type;
mod numbered_name;
mod optics;
mod parallax;
mod reading;
mod row_column;
mod view_list;

pub use arrangement::ViewLayout;
pub(crate) use finding::find_views;
pub use light_field_type::{LightField, SubAperture, ViewDisparity};
pub use optics::Optics;
pub use parallax::{GridTurn, GridTurnEstimate, estimate_grid_turn};
pub use reading::{LightFieldOptions, open_light_field};
