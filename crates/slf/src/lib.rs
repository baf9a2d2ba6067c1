//! The surface light field: radiance leaving a surface point.
//!
//! [`DirectLight`] is the light that a surface sends by itself, and what it reflects of lights and emissive
//! surfaces, once and diffusely: `punctual` holds the laws of point, spot and directional lights, `emitters`
//! the sampling of emissive surfaces.

mod direct_light;
mod emitters;
mod point_random;
mod punctual;

pub use direct_light::{DirectLight, DirectLightOptions};
