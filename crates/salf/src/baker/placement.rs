//! Where each triangle's samples are placed: in the pinhole picture, or on the surface itself.

use crate::view::View;
use glam::DVec2;
use scene::{Scene, SurfacePoint};

/// Which triangles are sampled on the surface.
///
/// The pinhole picture places samples well for most surfaces: their footprints are squares of the pixel grid and tile the
/// picture exactly. It does not for
///
/// * triangles that are nearly edge-on to the aperture, of which it sees next to nothing while the aperture's rim
///   does;
/// * small bright triangles, which its rays may miss, or hit and make too bright.
pub struct Placement {
    on_surface: Vec<bool>,
}

/// Emitted radiance above which a small triangle is sampled on the surface.
const BRIGHT: f32 = 2.0;

/// The largest extent, px, of a small triangle.
const SMALL_PX: f64 = 3.0;

impl Placement {
    /// Chooses which triangles get samples on their surface: those that turn their back to the aperture, and small
    /// bright ones.
    pub fn new(scene: &Scene, view: &View) -> Self {
        let on_surface = |triangle: u32| {
            !scene.is_splat(triangle)
                && (!view.faces_aperture(scene, triangle)
                    || is_bright(scene, triangle) && is_small(scene, view, triangle))
        };
        Self { on_surface: (0..scene.triangles.len() as u32).map(on_surface).collect() }
    }

    /// Whether the samples of a triangle (by its index in the scene) are placed on the triangle itself, not by
    /// pixels.
    pub fn is_on_surface(&self, triangle: u32) -> bool {
        self.on_surface[triangle as usize]
    }

    /// The triangles whose samples are placed on them, ascending.
    pub fn on_surface(&self) -> impl Iterator<Item = u32> {
        (0..self.on_surface.len() as u32).filter(|&triangle| self.is_on_surface(triangle))
    }
}

fn is_bright(scene: &Scene, triangle: u32) -> bool {
    let material = scene.material_of(triangle);
    let center = SurfacePoint { triangle, barycentric: DVec2::splat(1.0 / 3.0) };
    material.emissive.max_element() > BRIGHT && scene.emitted_radiance(center).max_element() > BRIGHT
}

/// Whether a triangle in front of the camera is small in the picture.
fn is_small(scene: &Scene, view: &View, triangle: u32) -> bool {
    let corners = scene.corners(triangle).map(|p| view.camera.camera_from_world(p));
    let pixels = corners.map(|p| view.camera.pixel_from_q(view.optics.chief(p)));
    let low = pixels[0].min(pixels[1]).min(pixels[2]);
    let high = pixels[0].max(pixels[1]).max(pixels[2]);
    corners.iter().all(|p| p.z > 0.0) && (high - low).max_element() <= SMALL_PX
}
