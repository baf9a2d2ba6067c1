//! Where visibility is computed from.

use glam::DVec3;
use scene::SurfacePoint;

/// Where the visibility of a square is computed from.
#[derive(Clone, Copy, Debug)]
pub enum Viewpoint {
    /// A point on a surface, which does not hide the square itself.
    Surface(SurfacePoint),
    /// Infinitely far in this direction from the square.
    Infinity(DVec3),
}

/// A viewpoint in the world.
#[derive(Clone, Copy)]
pub(crate) enum Eye {
    /// A point.
    At(DVec3),
    /// A direction.
    Toward(DVec3),
}
