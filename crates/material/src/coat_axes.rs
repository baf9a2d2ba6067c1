//! The orientation of a clearcoat relative to the surface beneath.

use crate::Frame;
use glam::DVec3;

/// The axes of a coat in the frame of the surface beneath; `None` where they are the same.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoatAxes(Option<[DVec3; 3]>);

impl CoatAxes {
    /// The axes for a frame that faces the eye.
    pub fn new(frame: &Frame) -> Self {
        if frame.coat == frame.normal {
            return Self(None);
        }
        let normal = frame.local(frame.coat).normalize_or(DVec3::Z);
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        Self(Some([tangent, bitangent, normal]))
    }

    /// A direction of the frame in these axes.
    pub fn local(&self, w: DVec3) -> DVec3 {
        self.0.map_or(w, |axes| DVec3::from_array(axes.map(|axis| axis.dot(w))))
    }

    /// The inverse of [`Self::local`].
    pub fn back(&self, w: DVec3) -> DVec3 {
        self.0.map_or(w, |[x, y, z]| x * w.x + y * w.y + z * w.z)
    }
}
