//! The surface light field: radiance leaving a surface point.

mod direct_light;

pub use direct_light::DirectLight;
