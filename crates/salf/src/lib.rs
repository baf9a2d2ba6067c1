//! The surface-aperture light field (SALF): for a fixed camera, the image of the aperture as each surface point sees it.

mod bake;
mod sample;

pub use bake::{BakeOptions, bake};
pub use sample::{Salf, Sample, Visibility};
