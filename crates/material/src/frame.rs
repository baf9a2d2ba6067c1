//! The orientation of a surface at a point.

use glam::DVec3;

/// The normals of a point and the direction of its anisotropy. Unit vectors.
///
/// The geometric normal alone decides on which side a direction lies: no shading normal lets light through from
/// behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The triangle's normal, on its front.
    pub geometric: DVec3,
    /// The shading normal.
    pub normal: DVec3,
    /// Perpendicular to the shading normal.
    pub tangent: DVec3,
    /// The normal of the clearcoat, which may have a normal map of its own.
    pub coat: DVec3,
}

impl Frame {
    /// A frame of normals and a tangent, which is made perpendicular to the shading normal; one along it, or 0, is
    /// replaced by any.
    pub fn new(geometric: DVec3, normal: DVec3, tangent: DVec3) -> Self {
        let upright = tangent - normal * normal.dot(tangent);
        let tangent = upright.try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector());
        Self { geometric, normal, tangent, coat: normal }
    }

    /// The same frame with a clearcoat whose normal is `coat` (world, unit).
    pub fn coated(self, coat: DVec3) -> Self {
        Self { coat, ..self }
    }

    /// A frame whose geometric, shading and coat normal are all `normal` (world, unit), with no preferred tangent.
    pub fn flat(normal: DVec3) -> Self {
        Self::new(normal, normal, DVec3::ZERO)
    }

    /// The frame as seen from `outgoing`: on its side, with shading normals that do not face away from it. One that does is moved toward
    /// the geometric normal until it is just perpendicular to the direction (as in Keller et al. 2017): visible surfaces are never shaded
    /// as if from behind.
    pub(crate) fn facing(&self, outgoing: DVec3) -> Self {
        let side = if self.geometric.dot(outgoing) < 0.0 { -1.0 } else { 1.0 };
        let geometric = self.geometric * side;
        let toward = geometric.dot(outgoing);
        let [normal, coat] = [self.normal, self.coat].map(|normal| {
            let normal = normal * side;
            let turned = normal.dot(outgoing);
            // A direction in the geometric plane itself sees nothing, whichever normal is used.
            const MIN_COSINE_RATIO: f64 = 1e-3;
            if turned >= MIN_COSINE_RATIO * toward || toward <= 0.0 {
                return normal;
            }
            // (1 − s)·turned + s·toward = LEAST·toward.
            let share = (MIN_COSINE_RATIO * toward - turned) / (toward - turned);
            normal.lerp(geometric, share).normalize_or(geometric)
        });
        let is_bent = normal != self.normal * side;
        let own = if is_bent {
            Self::new(geometric, normal, self.tangent)
        } else {
            Self { geometric, normal, ..*self }
        };
        own.coated(coat)
    }

    /// A direction in the frame's own axes: tangent, bitangent, normal.
    pub(crate) fn local(&self, w: DVec3) -> DVec3 {
        DVec3::new(self.tangent.dot(w), self.normal.cross(self.tangent).dot(w), self.normal.dot(w))
    }

    /// The inverse of [`Self::local`].
    pub(crate) fn world(&self, w: DVec3) -> DVec3 {
        self.tangent * w.x + self.normal.cross(self.tangent) * w.y + self.normal * w.z
    }

    /// The weight of light from `incident` where the shading normal leans away from the geometric one, in [0, 1]: it falls smoothly to 0
    /// where the triangle itself faces away, in place of a hard edge (Chiang, Li and Burley 2019, *Taming the shadow terminator*).
    pub(crate) fn terminator(&self, incident: DVec3) -> f64 {
        let shaded = self.normal.dot(incident) * self.geometric.dot(self.normal);
        let lit = self.geometric.dot(incident).abs();
        let g = if shaded > 0.0 { (lit / shaded).min(1.0) } else { 1.0 };
        g + g * g - g * g * g
    }
}
