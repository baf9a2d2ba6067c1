//! Where light is stored (texels of the surface, blocks of texels, cells at infinity), and at what resolution.

mod blocks;
mod direction_grid;
mod memory_budget;
mod texel_grid;

pub(crate) use blocks::TexelBlocks;
pub(crate) use direction_grid::DirectionGrid;
pub(crate) use memory_budget::MemoryBudget;
pub(crate) use texel_grid::{TexelGrid, Texels};
