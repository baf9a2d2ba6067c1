//! SALF and focus to picture: the sum of the aperture images, in integers.
//!
//! ```text
//! let mut splatter = Splatter::new(salf);             // once a bake
//! splatter.render(&camera, &focus, progress)?;        // the whole picture: first, or the lens has changed
//! let window = splatter.update(&focus, &changed)?;      // painted: subtract and add
//! let picture = splatter.picture();
//! ```
//!
//! Samples stand in a hierarchy ([`salf::tree`]), turned to integers once (`nodes`). A lens (`lens_in_use`) and paint
//! (`paint`) give each node its defocus κ, and so decide which nodes are drawn (`sums`): a sample itself where it is
//! nearly in focus, one node for many where they are far out of it. A node is drawn as the aperture's image (`draw`) of
//! rows that were cut once for all splats of its size (`stencil`, `shape`), on the level of a pyramid of accumulators
//! whose pixel is about its own size (`canvas`). Running sums and upsampling make the picture (`resolve`); partly
//! occluded samples share what open ones leave of it (`partition`), which leaves the sum of light as it is (`balance`).
//!
//! A picture that is too large for memory is summed in crops ([`CropSums`]), from a light field in parts.

mod aperture;
mod bands;
mod canvas;
mod crop;
mod draw;
mod draw_list;
mod fixed;
mod gpu;
mod lens_in_use;
mod nodes;
mod paint;
mod resolve;
mod simd_dispatch;
mod splatter;
mod sums;

pub use crop::{
    Crop, CropError, CropFacts, CropForm, CropJoiner, CropOptions, CropPicture, CropRow, CropSums, Integers,
    KNOT_NUMBERS, Kind,
};
pub use gpu::{AdapterDescription, BackendChoice, Gpu, GpuAbsent, PictureOnCard, adapters};
pub use lens_in_use::Tolerance;
pub use nodes::QUANTUM;
pub use splatter::{Mattes, SETS, SplatError, Splatter};
