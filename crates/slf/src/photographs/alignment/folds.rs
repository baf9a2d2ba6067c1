//! Separation of the texels that fit the alignment from those that validate it.

use crate::photographs::texels::{TexelBlocks, Texels};

/// The role of a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fold {
    Fitting,
    Validation,
}

/// Blocks of texels alternate like the squares of a chessboard.
pub(super) fn fold_of(blocks: &TexelBlocks, texels: &Texels, texel: usize) -> Fold {
    if blocks.is_even(blocks.block_of(texels, texel)) { Fold::Fitting } else { Fold::Validation }
}
