//! From a pointer to a surface: rays of the shot camera, and what they meet.

use focus::ViewFrame;
use glam::{DVec2, DVec3};
use lens::Camera;
use scene::{Scene, SurfacePoint};
use trace::{Ray, Tracer};

/// A point on a surface, as a view picked it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// Its address.
    pub point: SurfacePoint,
    /// Its place in the world.
    pub position: DVec3,
    /// Unit normal of its triangle, turned toward where the ray came from.
    pub normal: DVec3,
    /// World distance along the ray.
    pub distance: f64,
}

/// What `ray` meets first.
pub fn pick(tracer: &Tracer, ray: &Ray) -> Option<SurfaceHit> {
    let hit = tracer.first_hit(ray)?;
    let scene: &Scene = tracer.scene();
    let normal = scene.area_normal(hit.point.triangle).normalize_or_zero();
    Some(SurfaceHit {
        point: hit.point,
        position: hit.point.position(scene),
        normal: if normal.dot(ray.direction) > 0.0 { -normal } else { normal },
        distance: hit.t * ray.direction.length(),
    })
}

/// How far ahead of a camera is what it sees in the direction of a place in the world; none where no surface is.
pub fn depth_in_direction(tracer: &Tracer, camera: &Camera, position: DVec3) -> Option<f64> {
    let camera_space = camera.camera_from_world(position);
    if camera_space.z <= 0.0 {
        return None;
    }
    let pixel = camera.pixel_from_q(camera.optics().chief(camera_space));
    let hit = tracer.first_hit(&Ray::pinhole(camera, DVec2::ZERO, pixel))?;
    Some(camera.camera_from_world(hit.point.position(tracer.scene())).z)
}

/// The chief ray of a picture position: (0, 0) the upper left corner, (1, 1) the lower right, whatever the
/// resolution. Its direction has depth 1, so that t along it is axial depth.
pub fn chief_ray(camera: &Camera, position: DVec2) -> Ray {
    let size = DVec2::new(camera.width as f64, camera.height as f64);
    Ray::pinhole(camera, DVec2::ZERO, position * size)
}

/// The ray of a position in a view: (0, 0) the upper left corner, (1, 1) the lower right. Its direction has depth 1.
pub fn view_ray(view: &ViewFrame, position: DVec2) -> Ray {
    let (origin, direction) = view.ray(position);
    Ray { origin, direction, t_min: 0.0, t_max: f64::INFINITY, skip: None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_seen_as_a_view_has_the_same_rays() {
        let camera = Camera { width: 321, height: 200, yfov: 0.9, ..Camera::default() };
        let view = ViewFrame::from_camera(&camera);
        for position in [DVec2::ZERO, DVec2::new(0.3, 0.9), DVec2::ONE] {
            let (a, b) = (chief_ray(&camera, position), view_ray(&view, position));
            assert!(a.origin == b.origin && a.direction.distance(b.direction) < 1e-12);
        }
    }

    #[test]
    fn the_middle_looks_ahead_and_corners_land_where_the_lens_says() {
        let camera = Camera { width: 320, height: 200, ..Camera::default() };
        assert!(chief_ray(&camera, DVec2::splat(0.5)).direction.distance(DVec3::NEG_Z) < 1e-12);
        for position in [DVec2::ZERO, DVec2::new(1.0, 0.25)] {
            let point = camera.camera_direction(chief_ray(&camera, position).direction);
            assert!((point.z - 1.0).abs() < 1e-12);
            let pixel = camera.pixel_from_q(camera.optics().chief(point * 7.0));
            assert!(pixel.distance(position * DVec2::new(320.0, 200.0)) < 1e-9);
        }
    }
}
