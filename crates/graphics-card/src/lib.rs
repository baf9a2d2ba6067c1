//! A graphics card in use.
//!
//! [`Gpu::open`] picks an adapter, [`Gpu`] makes buffers and waits for work, [`Commands`] dispatches compute passes ([`Pass`]), and
//! passes are compiled once a card ([`Gpu::cached`]). A card that no longer answers is [`Lost`], and whoever used it goes on on the processor.
//!
//! Shaders are portable WGSL. What they share with Rust is written in Rust: [`constants!`] declares its constants.

mod adapter;
mod buffers;
mod cache;
mod commands;
pub mod constants;
mod device;
mod pass;
mod probe;
mod stopwatch;

pub use adapter::{AdapterDescription, BackendChoice, GpuAbsent, adapters};
pub use commands::Commands;
pub use device::{Gpu, Lost};
pub use pass::{Bound, Pass, bind_group_layout, shader_module};
pub use stopwatch::Stopwatch;
