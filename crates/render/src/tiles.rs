//! Tiled rendering: each tile is drawn in bounded memory, and merging the tiles gives the same bytes as rendering the whole picture.
//!
//! ```text
//! TileGrid, Shard ─▶ which tiles ─▶ render_tiles ─▶ a part a tile (part) ─▶ merge_tiles ─▶ the picture
//!                                        │ skips tiles that are finished by the same plan
//!                                        ▼
//!                      draw: pieces of a tile ─▶ crop: the light field around one, square by square
//! ```
//!
//! A part file holds a tile's contribution to the picture. Properties of the whole picture (gains, the precision of the integer sums,
//! whether anything is painted, the number of Cryptomatte ranks) are determined once all parts exist; everything a tile needs earlier is
//! fixed by the plan. The result does not depend on which process draws which tile, or when.

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
