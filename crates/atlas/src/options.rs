//! Options of unwrapping.

use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Duration;

/// The maximum side of an atlas in texels. Every GPU since 2010 supports textures of this size.
pub const MAX_SIDE: u32 = 8192;

/// The minimum number of empty texels between two charts: one on each side, so that a bilinear lookup at a chart's
/// border reads only its own texels and its own gutter.
pub const MIN_GUTTER: u32 = 2;

/// Resolution of the atlas.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Density {
    /// About 1024² texels for simple scenes, up to 2048² for scenes of many triangles.
    #[default]
    Auto,
    /// Texels per unit of world length (> 0). Reduced, with a note, if the atlas would exceed [`MAX_SIDE`].
    TexelsPerUnit(f64),
    /// The densest atlas that fits a square of this side in texels.
    Side(u32),
}

/// What to do with texture coordinates that the scene already has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum UvPolicy {
    /// Reuse a part's first sound set: its islands become charts. Sound means finite, inside [0, 1], no overlap, no
    /// collapsed triangle, nowhere stretched more than fourfold. Other parts are unwrapped.
    #[default]
    Auto,
    /// Unwrap every part.
    Ignore,
}

/// Options of [`crate::Atlas::unwrap`].
#[derive(Clone, Debug, PartialEq)]
pub struct UnwrapOptions {
    /// Resolution of the atlas.
    pub density: Density,
    /// Empty texels between two charts; at least [`MIN_GUTTER`].
    pub gutter: u32,
    /// What to do with existing texture coordinates.
    pub uv: UvPolicy,
    /// The program that runs the unwrapping engines, whose `main` must start with [`crate::child::run_if_child`]
    /// (usually the running program itself). Without one the pure-Rust engine runs in this process, and the deadline
    /// does not apply.
    pub child: Option<PathBuf>,
    /// What `child` is started with before the words for the engines: nothing where it is a program of ours; where it is an
    /// interpreter, the script that calls [`crate::child::run`].
    pub child_arguments: Vec<OsString>,
    /// Time limit for a child's batch of patches. After that the child is killed and the next engine tries.
    pub deadline: Duration,
}

impl Default for UnwrapOptions {
    fn default() -> Self {
        Self {
            density: Density::Auto,
            gutter: 4,
            uv: UvPolicy::Auto,
            child: None,
            child_arguments: Vec::new(),
            deadline: Duration::from_secs(30),
        }
    }
}
