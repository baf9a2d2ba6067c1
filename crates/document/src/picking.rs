//! Picking: rays through a pointer's position, and the surfaces that they hit.

use atlas::TexelMap;
use focus::ViewFrame;
use glam::{DVec2, DVec3};
use lens::Camera;
use rayon::prelude::*;
use scene::{Scene, SurfacePoint};
use trace::{Ray, Tracer};

/// A picked point on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// Its triangle and barycentric coordinates.
    pub point: SurfacePoint,
    /// Its position in world space.
    pub position: DVec3,
    /// Unit normal of its triangle, facing the ray's origin.
    pub normal: DVec3,
    /// Distance along the ray, in scene units.
    pub distance: f64,
}

/// The first surface that `ray` hits; `None` if there is none.
pub fn pick(tracer: &Tracer, ray: &Ray) -> Option<SurfaceHit> {
    let hit = tracer.visible_surface(ray)?;
    let scene: &Scene = tracer.scene();
    let normal = scene.area_normal(hit.point.triangle).normalize_or_zero();
    Some(SurfaceHit {
        point: hit.point,
        // A splat is met away from its mean.
        position: match scene.is_splat(hit.point.triangle) {
            true => ray.origin + ray.direction * hit.t,
            false => hit.point.position(scene),
        },
        normal: if normal.dot(ray.direction) > 0.0 { -normal } else { normal },
        distance: hit.t * ray.direction.length(),
    })
}

/// The depth of the surface that a camera sees in the direction of a world position; `None` where it sees none.
pub fn depth_in_direction(tracer: &Tracer, camera: &Camera, position: DVec3) -> Option<f64> {
    let camera_space = camera.camera_from_world(position);
    if camera_space.z <= 0.0 {
        return None;
    }
    let pixel = camera.pixel_from_q(camera.optics().chief(camera_space));
    // The depth of the ray's direction is 1.
    tracer.visible_surface(&Ray::pinhole(camera, DVec2::ZERO, pixel)).map(|hit| hit.t)
}

/// The chief ray of a picture position: (0, 0) is the upper left corner, (1, 1) the lower right, at any resolution. The depth of its
/// direction is 1, so that t along it is axial depth.
pub fn chief_ray(camera: &Camera, position: DVec2) -> Ray {
    let size = DVec2::new(camera.width as f64, camera.height as f64);
    Ray::pinhole(camera, DVec2::ZERO, position * size)
}

/// Which texels of the atlas a camera sees in the pixels of `mask`, width × height of its picture, row 0 on top: for each texel, row by row,
/// whether the middle of what it covers is seen, in a pixel of the mask. A mask of another length covers no more than it has.
pub fn texels_in_mask(tracer: &Tracer, texels: &TexelMap, camera: &Camera, mask: &[bool]) -> Vec<bool> {
    let (optics, eye, scene) = (camera.optics(), camera.position(), tracer.scene());
    let size = DVec2::new(camera.width.into(), camera.height.into());
    let is_masked = |position: DVec3| {
        let camera_space = camera.camera_from_world(position);
        if camera_space.z <= 0.0 {
            return false;
        }
        let pixel = camera.pixel_from_q(optics.chief(camera_space));
        let is_inside = pixel.cmpge(DVec2::ZERO).all() && pixel.cmplt(size).all();
        is_inside
            && mask
                .get(pixel.y as usize * camera.width as usize + pixel.x as usize)
                .is_some_and(|is_set| *is_set)
    };
    let seen = texels.texels.par_iter().filter(|texel| {
        is_masked(texel.centroid.position(scene)) && !tracer.is_hidden_from(texel.centroid, eye)
    });
    let mut selected = vec![false; texels.width as usize * texels.height as usize];
    for texel in seen.collect::<Vec<_>>() {
        selected[texel.y as usize * texels.width as usize + texel.x as usize] = true;
    }
    selected
}

/// The ray of a position in a view: (0, 0) is the upper left corner, (1, 1) the lower right. The depth of its direction is 1.
pub fn view_ray(view: &ViewFrame, position: DVec2) -> Ray {
    let (origin, direction) = view.ray(position);
    Ray { origin, direction, t_min: 0.0, t_max: f64::INFINITY, skip: None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_of_the_shot_camera_has_the_same_rays() {
        let camera = Camera { width: 321, height: 200, yfov: 0.9, ..Camera::default() };
        let view = ViewFrame::from_camera(&camera);
        for position in [DVec2::ZERO, DVec2::new(0.3, 0.9), DVec2::ONE] {
            let (a, b) = (chief_ray(&camera, position), view_ray(&view, position));
            assert!(a.origin == b.origin && a.direction.distance(b.direction) < 1e-12);
        }
    }

    #[test]
    fn the_centre_ray_points_forward_and_rays_project_to_their_positions() {
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
