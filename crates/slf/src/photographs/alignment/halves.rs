//! What photographs are aligned by, and what the alignment is judged by: never the same.

use crate::photographs::places::{Blocks, Texels};

/// What a place of the atlas is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Half {
    Asked,
    Judging,
}

/// Blocks of texels take turns, like the fields of a chess board.
pub(super) fn half_of(blocks: &Blocks, texels: &Texels, texel: usize) -> Half {
    if blocks.is_white(blocks.of_texel(texels, texel)) { Half::Asked } else { Half::Judging }
}
