//! What `.salf` files are refused for.

use crate::BakedOn;
use std::io;

/// The first version of the format that is read: that of light fields baked on the processor, of which no sample is a splat's. One more has
/// records of splats, two more were baked on a graphics card.
const FIRST: u32 = 6;

/// The last version that is read.
const LAST: u32 = FIRST + 3;

/// The version that a light field is written in.
pub fn version(has_splats: bool, baked_on: BakedOn) -> u32 {
    FIRST + u32::from(has_splats) + if baked_on == BakedOn::Card { 2 } else { 0 }
}

/// What a version tells: whether it has records of splats, and what it was baked on. `None` for versions that are not known.
pub fn content_of(version: u32) -> Option<(bool, BakedOn)> {
    let more = version.checked_sub(FIRST).filter(|_| version <= LAST)?;
    Some((more % 2 == 1, if more >= 2 { BakedOn::Card } else { BakedOn::Processor }))
}

/// Why a `.salf` file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SalfFileError {
    /// It cannot be read to its end.
    #[error("cannot be read: {0} (check the path, or bake it again)")]
    Io(#[from] io::Error),
    /// It is something else.
    #[error("not a .salf file (bake one with `focus-brush bake`)")]
    NotSalf,
    /// It is of another version.
    #[error("version {0} of the .salf format is not known, only {FIRST} to {LAST} (bake it again)")]
    Version(u32),
    /// It ends early.
    #[error("cut short (copy it again, or bake it again)")]
    CutShort,
    /// A value in it makes no sense.
    #[error("damaged: {0} (copy it again, or bake it again)")]
    Damaged(String),
}
