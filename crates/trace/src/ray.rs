//! A ray and what it hits.

use glam::{DVec2, DVec3};
use lens::Camera;
use scene::SurfacePoint;

/// The points origin + t·direction for t in (t_min, t_max). World space; `direction` need not be unit.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Direction of any length; t is in multiples of it.
    pub direction: DVec3,
    /// Hits at or before this t are ignored.
    pub t_min: f64,
    /// Hits at or after this t are ignored.
    pub t_max: f64,
    /// A triangle that is ignored (the one the ray starts on).
    pub skip: Option<u32>,
}

impl Ray {
    /// The ray along which a pinhole at the aperture point `u` (scene units; zero gives the chief ray) images the picture
    /// position `pixel` (px, the frame's upper left corner at zero).
    ///
    /// All aperture points image the same directions: an infinitely distant point has the same `pixel` for all of them. The
    /// direction has depth 1, so that t along the ray is axial depth.
    pub fn pinhole(camera: &Camera, u: DVec2, pixel: DVec2) -> Self {
        let direction = camera.q_from_pixel(pixel) * (camera.yfov / 2.0).tan();
        Self {
            origin: camera.world_from_camera(u.extend(0.0)),
            direction: camera.world_direction(direction.extend(1.0)),
            t_min: 0.0,
            t_max: f64::INFINITY,
            skip: None,
        }
    }
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// The point's address.
    pub point: SurfacePoint,
    /// Its t along the ray.
    pub t: f64,
}
