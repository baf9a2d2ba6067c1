//! Transfers paint when the scene's surface has changed: moved vertices, new UVs, another mesh of the same object.
//!
//! ```text
//! the painted surface ─▶ OldSurface (a node's triangles in a tree)
//!   a texel of the new atlas ─▶ alignment (where the node was) ─▶ nearest point with a similar normal ─▶ old atlas ─▶ its paint
//! ```
//!
//! Texels without a corresponding point keep the ordinary lens, and are listed by node.

mod alignment;
mod correspondences;
mod old_surface;
mod transferred_paint;

pub(crate) use transferred_paint::transfer_paint;
pub use transferred_paint::{TransferredPaint, UnmatchedNode};
