//! The samples as a hierarchy: quadtrees of samples that lie on one smooth surface.
//!
//! A splat that spreads its light over a circle of confusion of D pixels does not care for samples closer together than a
//! fraction of D. So samples are joined, the quadrants of a cell and then two cells by two, to nodes that stand for all of them: their weight, their mean
//! position, radiance, depth and tilt, how far they spread, and what most of them see of the aperture. Which nodes are
//! used is decided when the picture is made, from the defocus that each then has; the hierarchy knows no focus.
//!
//! Only like is joined with like: samples of about one depth, and among the partly occluded ones those that see about the
//! same part of the aperture. Highlights are joined within their cell only: their aperture images are seen one by one.

mod build;
mod grid;

use glam::{Vec2, Vec3};
use std::ops::Range;

pub use build::each_block;

/// Side of a block, px: no node is larger.
pub const BLOCK_PX: i32 = crate::domain::Domain::BLOCK;

/// Levels of the hierarchy: cells of 1, 2, 4, 8 and 16 px.
pub const LEVELS: usize = BLOCK_PX.ilog2() as usize + 1;

/// The hierarchy over the samples of a square of [`BLOCK_PX`] pixels. Places are counted from the block's beginning.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// The roots, then the children of all of these, and so on. So what is drawn of a block, nodes that are about as far below
    /// the roots, lies together.
    pub nodes: Vec<Node>,
    /// How many of them have no parent.
    pub roots: u32,
    /// The visibility of nodes: 16 × 16 cells, four rows per word (see [`crate::Visibility::Cells`]).
    pub cells: Vec<[u64; 4]>,
}

/// One sample, or several as one.
#[derive(Clone, Debug)]
pub struct Node {
    /// Mean position in the pinhole picture, px.
    pub center: Vec2,
    /// Half the sides of its footprint, px: a box of its variance.
    pub half_size: Vec2,
    /// Mean inverse depth, 1/length; 0 for the background.
    pub inverse_depth: f32,
    /// How far the inverse depths of the samples below it lie apart, 1/length.
    pub inverse_depth_spread: f32,
    /// Weight toward the aperture's centre, px² (see [`crate::Sample`]).
    pub weight: f32,
    /// Its change over the aperture, px².
    pub tilt: Vec2,
    /// Mean radiance.
    pub radiance: Vec3,
    /// How far from `center` the light of the samples below it lies: of the colour of which that is most, the length of the
    /// mean of its radiance times its distance, px. 0 for a sample.
    pub dipole: f32,
    /// Its cell has a side of 2 to this, px.
    pub level: u8,
    /// The index of its visibility in [`Block::cells`]; `None` if it sees the whole aperture.
    pub cells: Option<u32>,
    /// The nodes that it replaces, fewer than 32; none if it is a sample.
    pub children: Range<u32>,
    /// The number of the sample in the light field, if it is one.
    pub sample: Option<u32>,
}
