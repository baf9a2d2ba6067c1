//! What `.salf` files are refused for.

use std::io;

/// The version of the format that is written where no sample is a splat's.
pub const VERSION: u32 = 6;
/// The version that has records of splats.
pub const VERSION_WITH_SPLATS: u32 = 7;

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
    #[error(
        "version {0} of the .salf format is not known, only {VERSION} and {VERSION_WITH_SPLATS} (bake it again)"
    )]
    Version(u32),
    /// It ends early.
    #[error("cut short (copy it again, or bake it again)")]
    CutShort,
    /// A value in it makes no sense.
    #[error("damaged: {0} (copy it again, or bake it again)")]
    Damaged(String),
}
