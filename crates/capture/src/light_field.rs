//! Light fields: pictures of one place from many points of an aperture.
//!
//! The stages for a light field: `view_discovery` (which naming scheme the files follow) → `row_column`, `hexagon`, `view_list` (each yields
//! an `Arrangement`: file and position of every view), or a [`crate::Mosaic`] → `reading` (sizes, what is missing, `optics`, `disparity`)
//! → `parallax` (whether rows or columns run as their names say).

mod arrangement;
mod attributes;
mod disparity;
mod hexagon;
mod light_field_type;
mod numbered_grid;
mod numbered_name;
mod optics;
mod parallax;
mod reading;
mod row_column;
mod view_discovery;
mod view_list;

pub use arrangement::ViewLayout;
pub use light_field_type::{LightField, SubAperture, ViewDisparity};
pub use optics::Optics;
pub use parallax::{GridTurn, GridTurnEstimate, estimate_grid_turn};
pub use reading::{LightFieldOptions, open_light_field};
pub(crate) use view_discovery::find_views;
