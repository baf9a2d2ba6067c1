//! The orientation of a clearcoat relative to the surface beneath.

use crate::Frame;
use glam::DVec3;

/// The axes of a coat in the frame of the surface beneath; `None` where they are the same.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoatAxes(Option<[DVec3; 3]>);

impl CoatAxes {
    /// The clearcoat's axes, for a frame that faces the eye; none of its own where the coat has the surface's normal.
    pub fn new(frame: &Frame) -> Self {
        if frame.coat == frame.normal {
            return Self(None);
        }
        let normal = frame.local(frame.coat).normalize_or(DVec3::Z);
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        Self(Some([tangent, bitangent, normal]))
    }

    /// A direction given in the frame's axes, in the coat's: z along its normal.
    pub fn local(&self, w: DVec3) -> DVec3 {
        self.0.map_or(w, |axes| DVec3::from_array(axes.map(|axis| axis.dot(w))))
    }

    /// A direction given in the coat's axes, in the frame's. The inverse of [`Self::local`].
    pub fn back(&self, w: DVec3) -> DVec3 {
        self.0.map_or(w, |[x, y, z]| x * w.x + y * w.y + z * w.z)
    }
}
