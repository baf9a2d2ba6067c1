//! The sum on a graphics card, with the same bits as on the processor.
//!
//! Nodes are uploaded once per bake ([`scene`]), stencils as they are needed ([`shapes`]). For each picture the card lists the
//! nodes to draw ([`listing`]), draws them onto accumulators of its own ([`sums`]), integrates these ([`resolve`]), and keeps the
//! picture, which can be shown without being read back. The changes of a stroke are listed by the processor ([`records`]),
//! subtracted and added on the card.
//!
//! The shaders are portable WGSL without optional features: integers of 64 bits are pairs of words, atomic sums of 64 bits carry
//! by hand. Each shader lies beside the Rust file of the same name that computes the same; constants and layouts come from Rust
//! ([`shader_source`], [`shader_structs`], [`formats`]).

mod error;
mod formats;
mod layout;
mod listing;
mod pace;
mod passes;
mod picture_on_card;
mod records;
mod resolve;
mod scene;
mod shader_source;
mod shader_structs;
#[cfg(test)]
mod shader_tests;
mod shapes;
mod sums;
#[cfg(test)]
mod tests;

pub(crate) use error::GpuError;
pub use picture_on_card::PictureOnCard;
pub(crate) use sums::GpuSums;
