//! A picture in tiles: each is drawn within the memory of a tile, and they are merged to the bytes of the whole.
//!
//! ```text
//! TileGrid, Shard ─▶ which tiles ─▶ render_tiles ─▶ a part a tile (part) ─▶ merge_tiles ─▶ the picture
//!                                        │ skips what is finished by the same plan
//!                                        ▼
//!                      draw: pieces of a tile ─▶ crop: the light field around one, square by square
//! ```
//!
//! A part holds what its tile brings to the picture. What the picture decides as a whole (gains, the finest integers, whether
//! anything is painted, how many ranks of things there are) is decided when all parts are there; what a tile has to know before, is the
//! same for all by their plan. Nothing depends on who draws which tile, nor on when.

mod crop;
mod draw;
mod grid;
mod joined_picture;
mod lit_picture;
mod merge;
mod part;
mod run;

pub use grid::TileGrid;
pub use merge::{Merged, merge_tiles};
pub use run::{TileOptions, TileReport, TilesReport, render_tiles};
