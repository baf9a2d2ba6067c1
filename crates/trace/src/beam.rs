//! Rays from one point, close together: their first hits in a single traversal of the hierarchy.

use crate::hierarchy::Halfspaces;
use crate::local_space::LocalSpace;
use crate::watertight::ShearedRayPacket;
use glam::DVec3;

/// A pyramid of rays.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// The common origin of its rays.
    pub origin: DVec3,
    /// A unit vector along which the directions of all rays have the length 1, so that t is depth.
    pub axis: DVec3,
    /// The directions of its four edges, in order around it.
    pub edges: [DVec3; 4],
}

impl Beam {
    /// The largest number of rays that can be traced together.
    pub const MAX_RAYS: usize = ShearedRayPacket::MAX;

    /// The part of the world that its rays pass through, generously, and the direction in which it widens.
    pub(crate) fn shaft(&self, space: &LocalSpace) -> Halfspaces {
        let origin = space.position(self.origin);
        let middle = origin + self.edges.iter().sum::<DVec3>();
        let mut shaft = Halfspaces::toward(self.axis);
        for k in 0..4 {
            shaft.add(self.edges[k].cross(self.edges[(k + 1) % 4]), origin, middle);
        }
        shaft
    }

    /// How far along the axis a hit at t lies, in that space and not nearer than it is.
    pub(crate) fn height(&self, space: &LocalSpace, t: f64) -> f32 {
        Halfspaces::height(self.axis, space.position(self.origin + self.axis * t))
    }
}
