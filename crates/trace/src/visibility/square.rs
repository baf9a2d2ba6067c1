//! Squares of points, such as apertures lie in.

use glam::{DVec2, DVec3};

/// A square of points in the world: `center` + u·`right` + v·`up`, u and v in [−1, 1].
#[derive(Clone, Copy, Debug)]
pub struct Square {
    /// Its middle.
    pub center: DVec3,
    /// To the middle of its side at u = 1; its length is half a side.
    pub right: DVec3,
    /// To the middle of its side at v = 1; at a right angle to `right`, and as long.
    pub up: DVec3,
}

impl Square {
    /// The world position of a place on the square, each coordinate in [−1, 1].
    pub fn world_position(&self, place: DVec2) -> DVec3 {
        self.center + place.x * self.right + place.y * self.up
    }

    pub(crate) fn corners(&self) -> [DVec3; 4] {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(u, v)| self.world_position(DVec2::new(u, v)))
    }

    /// Its axis, to one side or the other.
    pub(super) fn axis(&self) -> DVec3 {
        self.right.cross(self.up).normalize_or_zero()
    }
}
