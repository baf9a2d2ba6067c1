//! Where light is kept: at texels of the surface and in cells at infinity, by blocks where it changes slowly, and how fine all that is.

mod blocks;
mod budget;
mod sphere;
mod texels;

pub(crate) use blocks::Blocks;
pub(crate) use budget::Budget;
pub(crate) use sphere::Sphere;
pub(crate) use texels::{TexelGrid, Texels};
