//! Paint that follows the surface when the scene's file is another: moved vertices, new UVs, another mesh of the same thing.
//!
//! ```text
//! the surface that was painted ─▶ OldSurface (a node's triangles in a tree)
//!   a texel of the new atlas ─▶ alignment (where the node was) ─▶ nearest point with a like normal ─▶ the old atlas ─▶ its paint
//! ```
//!
//! What finds no partner keeps the ordinary lens, and is listed by node.

mod alignment;
mod correspondences;
mod old_surface;
mod transferred_paint;

pub(crate) use transferred_paint::transfer_paint;
pub use transferred_paint::{TransferredPaint, UnmatchedNode};
