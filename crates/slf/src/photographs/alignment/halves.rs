//! What photographs are aligned by, and what the alignment is judged by: never the same.

use crate::photographs::places::{TexelBlocks, Texels};

/// What a place of the atlas is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fold {
    Fitting,
    Validation,
}

/// Blocks of texels take turns, like the fields of a chess board.
pub(super) fn fold_of(blocks: &TexelBlocks, texels: &Texels, texel: usize) -> Fold {
    if blocks.is_even(blocks.block_of(texels, texel)) { Fold::Fitting } else { Fold::Validation }
}
