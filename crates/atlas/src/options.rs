//! How a scene is to be unwrapped.

use std::path::PathBuf;
use std::time::Duration;

/// The largest atlas side in texels. Every GPU since 2010 takes textures of this size.
pub const MAX_SIDE: u32 = 8192;

/// The smallest number of empty texels between two charts: one each side, so that a bilinear lookup at a
/// chart's border reads only its own texels and its own gutter.
pub const MIN_GUTTER: u32 = 2;

/// How fine the atlas is.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Density {
    /// An atlas of about 1024² texels for simple scenes, up to 2048² for those of many triangles.
    #[default]
    Auto,
    /// Texels per unit of world length (> 0). Reduced, with a note, where the atlas would exceed [`MAX_SIDE`].
    TexelsPerUnit(f64),
    /// The densest atlas that fits a square of this side in texels.
    Side(u32),
}

/// What becomes of texture coordinates that the scene already has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum UvPolicy {
    /// A part's first sound set is kept: its islands become charts. Sound: finite, inside [0, 1], no overlap, no
    /// collapsed triangle, nowhere stretched more than fourfold. Other parts are unwrapped.
    #[default]
    Auto,
    /// Every part is unwrapped.
    Ignore,
}

/// Options of [`crate::Atlas::unwrap`].
#[derive(Clone, Debug, PartialEq)]
pub struct UnwrapOptions {
    /// How fine the atlas is.
    pub density: Density,
    /// Empty texels between two charts; at least [`MIN_GUTTER`].
    pub gutter: u32,
    /// What becomes of existing texture coordinates.
    pub uv: UvPolicy,
    /// The program that runs the unwrapping engines, one whose main begins with [`crate::child::run_if_asked`]
    /// (usually the running program itself). Without one the pure-Rust engine runs in this process, and the
    /// deadline does not bind.
    pub child: Option<PathBuf>,
    /// How long a child may work on its batch of patches. After that it is killed and the next engine tries.
    pub deadline: Duration,
}

impl Default for UnwrapOptions {
    fn default() -> Self {
        Self {
            density: Density::Auto,
            gutter: 4,
            uv: UvPolicy::Auto,
            child: None,
            deadline: Duration::from_secs(30),
        }
    }
}
