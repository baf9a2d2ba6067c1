//! The gloss of a picture at a surface point.

use crate::{PictureGloss, Scene, SurfacePoint};
use glam::{DVec2, DVec3, Vec3};

impl Scene {
    /// The gloss to be added to the picture's light at a point, toward a world position; may be below 0.
    #[inline]
    pub fn picture_gloss_radiance(&self, point: SurfacePoint, eye: DVec3) -> Vec3 {
        if self.picture.is_none() { Vec3::ZERO } else { self.interpolate_picture_gloss(point, eye) }
    }

    fn interpolate_picture_gloss(&self, point: SurfacePoint, eye: DVec3) -> Vec3 {
        let Some((gloss, picture_position)) = self.locate_picture_gloss(point) else { return Vec3::ZERO };
        // Surfaces of pictures lie in front of the origin, where their camera is and looks along −z.
        let position = point.position(self);
        let ahead = eye.z - position.z;
        if ahead <= 0.0 {
            return Vec3::ZERO;
        }
        let aperture = position + (eye - position) * (-position.z / ahead);
        gloss.radiance_offset(picture_position, aperture.truncate())
    }

    /// The angle, in rad, that the captured aperture subtends at a point whose light varies over it; `None` for other
    /// points.
    pub fn picture_gloss_angle(&self, point: SurfacePoint) -> Option<f64> {
        let (gloss, picture_position) = self.locate_picture_gloss(point)?;
        let widest = gloss.aperture_half_extent[0].max(gloss.aperture_half_extent[1]);
        gloss.varies_at(picture_position).then(|| 2.0 * widest / -point.position(self).z)
    }

    /// The gloss of the picture that a point shows, and the point's position in the picture.
    fn locate_picture_gloss(&self, point: SurfacePoint) -> Option<(&PictureGloss, DVec2)> {
        let picture = self.picture.as_ref()?;
        let gloss = picture.gloss.as_ref()?;
        let corners = self.triangles[point.triangle as usize].vertices.map(|v| self.uv[0][v as usize]);
        let uv: DVec2 = corners.iter().zip(point.weights()).map(|(uv, weight)| uv.as_dvec2() * weight).sum();
        let size = DVec2::new(f64::from(picture.size[0]), f64::from(picture.size[1]));
        let picture_position = uv * size - f64::from(picture.margin);
        let [width, height] = picture.picture_size().map(f64::from);
        let is_in = picture_position.x >= 0.0
            && picture_position.y >= 0.0
            && picture_position.x <= width
            && picture_position.y <= height;
        is_in.then_some((gloss, picture_position))
    }
}
