//! Studies of one scene beyond speed against error: live preview, left-out photographs, light-field views,
//! refined light.

pub mod left_out_photographs;
pub mod light_field_views;
pub mod live_preview;
pub mod refined_light;
