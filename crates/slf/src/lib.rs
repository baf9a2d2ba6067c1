//! The surface light field: radiance leaving a surface point.
//!
//! [`Transport`] traces it by paths. `material_point` looks up what a point is made of; `lights` draws what may shine on it:
//! `punctual` (the laws of point, spot and directional lights), `emitters` (emissive surfaces), `environment_light` (and `open_sky`, what it sends where nothing shades). `media` knows
//! what bodies a path is in; `path_random` has its numbers. [`Irradiance`] keeps what was scattered before, for
//! every camera; `solving` finds it. [`PhotographLight`] answers the same question from photographs. `spots` tells many points of a picture by a few.

mod emitters;
mod environment_light;
mod irradiance;
mod light_tree;
mod lights;
mod material_point;
mod media;
mod open_sky;
mod path_random;
mod photographs;
mod punctual;
mod solving;
mod spots;
mod transport;

pub use irradiance::Irradiance;
pub use material::Scattering;
pub use photographs::{
    DirectPhotographs, Exposure, LightTexture, PhotographError, PhotographLight, PhotographModel,
    PhotographOptions, Poses,
};
pub use solving::IrradianceOptions;
pub use transport::{Transport, TransportOptions};
