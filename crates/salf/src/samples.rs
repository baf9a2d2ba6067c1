//! The samples of a light field, packed.
//!
//! A [`Sample`](crate::Sample) takes a hundred bytes and more. Packed, a cell of the picture, or a part of one, takes 16 bytes: which cell
//! of which block, the plane it lies on (a number among those of its block), its surface address, depth and radiance. Where
//! its footprint is and what it weighs follows from the cell and its sub-cells ([`crate::Cell::part`]), how its weight changes over the
//! aperture from the plane. A patch of surface takes 10 bytes more, a partly visible aperture about 4 ([`masks`]). A Gaussian splat has no plane: nearly
//! each would need one of its own, for its weight. What does not fit such a form, like a radiance of 2⁶⁴, is stored unpacked.
//!
//! What is lost: depths are exact to 2⁻¹⁷ of themselves, radiances to 2⁻¹⁰ of their largest channel, addresses to 1/65535 of
//! their triangle, weights over the aperture to 2⁻¹¹ beside its centre; places of patches to 1/4096 px. Footprints and
//! weights of cells, and visibility, are exact.

mod arrays;
mod check;
mod masks;
mod numbers;
mod pack;
mod plane;
mod record;
mod run;

pub use arrays::Samples;
pub(crate) use arrays::{Chunk, Starts};
pub(crate) use pack::{BakedSample, Packer, block_corner};
pub(crate) use plane::Plane;
pub(crate) use record::{Patch, Record};
pub use run::{Addresses, Run, SampleLocation};

#[cfg(test)]
mod tests;
