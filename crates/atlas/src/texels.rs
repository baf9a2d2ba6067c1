//! Texels of the atlas: what each covers, exactly, and the gutters around charts.

mod clip;
mod coverage;
mod dilation;
mod texel_map;

pub use coverage::AtlasTexel;
pub use dilation::{DILATION_RADIUS, Dilation};
pub use texel_map::{NO_TEXEL, TexelMap};
