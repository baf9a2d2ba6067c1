//! The sum on a graphics card: the same bits as on the processor.
//!
//! Nodes are uploaded once a bake ([`scene`]), stencils as they are needed ([`shapes`]). For each picture the card finds which
//! nodes are drawn ([`listing`]), draws them onto accumulators of its own ([`sums`]), integrates these, and keeps the
//! picture, which may be shown without coming back. What a stroke changes is listed by the processor ([`records`]), and
//! taken away and added there too.
//! Portable WGSL that needs no optional features: 64 bits are pairs of words, adders of 64 bits carry by atomics.

mod device;
mod error;
mod layout;
mod listing;
mod pace;
mod passes;
mod picture_on_card;
mod probe;
mod records;
mod resolve;
mod scene;
mod shapes;
mod sums;
#[cfg(test)]
mod tests;

pub use device::Gpu;
pub use device::adapter::{AdapterDescription, BackendChoice, GpuAbsent, adapters};
pub(crate) use error::GpuError;
pub use picture_on_card::PictureOnCard;
pub(crate) use sums::GpuSums;
