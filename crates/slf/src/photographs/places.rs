//! Where light is kept: at texels of the surface and in cells at infinity, by blocks where it changes slowly, and how fine all that is.

mod blocks;
mod budget;
mod sphere;
mod texels;

pub(crate) use blocks::TexelBlocks;
pub(crate) use budget::MemoryBudget;
pub(crate) use sphere::DirectionGrid;
pub(crate) use texels::{TexelGrid, Texels};
