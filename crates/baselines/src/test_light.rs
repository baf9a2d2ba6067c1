//! Light, focus, a camera and simple surfaces for the tests, and what is measured on their pictures.

use crate::FirstHits;
use glam::{DVec2, DVec3, Vec3};
use lens::{Camera, FocusOffset, Picture};
use progress::{Progress, Unwatched};
use salf::{BakeOptions, Salf};
use scene::{Scene, SurfaceField, SurfacePoint};
use std::sync::Arc;
use test_scenes::Mesh;
use trace::{OutgoingRadiance, Radiance, Tracer};

/// Every surface sends its material's base colour; the background is black.
pub struct BaseColor(pub Arc<Scene>);

impl Radiance for BaseColor {
    fn outgoing(&self, point: SurfacePoint, _eye: DVec3) -> OutgoingRadiance {
        OutgoingRadiance::from_own(self.0.base_color(point).truncate())
    }
    fn environment(&self, _direction: DVec3) -> Vec3 {
        Vec3::ZERO
    }
}

/// One focus for each part, the last also for the background.
pub struct ByPart(pub Arc<Scene>, pub Vec<FocusOffset>);

impl SurfaceField<FocusOffset> for ByPart {
    fn at(&self, point: SurfacePoint) -> FocusOffset {
        let part = self.0.triangles[point.triangle as usize].part as usize;
        self.1[part.min(self.1.len() - 1)]
    }
    fn at_infinity(&self) -> FocusOffset {
        FocusOffset::STANDARD
    }
}

/// A square picture of `side` px, focused at 3 with a wide disc.
pub fn camera(side: u32) -> Camera {
    Camera {
        width: side,
        height: side,
        yfov: 0.6,
        focus_distance: 3.0,
        aperture_radius: 0.15,
        sensor_height: 0.08,
        ..Camera::default()
    }
}

/// The size of a pixel of `camera`'s picture at depth z, scene units.
pub fn pixel_at(camera: &Camera, z: f64) -> f64 {
    z * camera.optics().tan_half_yfov / camera.optics().half_height_px
}

/// A rectangle that faces the camera at depth z, `low` and `high` its corners.
pub fn card(low: [f64; 2], high: [f64; 2], z: f64) -> Mesh {
    let side = DVec3::X * (high[0] - low[0]);
    let other = DVec3::Y * (high[1] - low[1]);
    Mesh::rectangle(DVec3::new(low[0], low[1], -z), side, other)
}

/// A square around the pixel position `center` of `camera`'s picture, `side` px wide when seen sharp, at depth z.
pub fn spot(camera: &Camera, center: DVec2, side: f64, z: f64) -> Mesh {
    let pixel = pixel_at(camera, z);
    let middle = DVec2::new(f64::from(camera.width), f64::from(camera.height)) / 2.0;
    let at = (center - middle) * DVec2::new(pixel, -pixel);
    let half = DVec2::splat(side / 2.0 * pixel);
    card((at - half).to_array(), (at + half).to_array(), z)
}

/// A wall of depth z that fills the picture and all that may shine into it.
pub fn wall(z: f64) -> Mesh {
    card([-9.0 * z, -9.0 * z], [9.0 * z, 9.0 * z], z)
}

/// What the pinhole of `camera` sees.
pub fn first_hits(scene: &Arc<Scene>, camera: &Camera, focus: &ByPart) -> FirstHits {
    let tracer = Tracer::new(scene.clone());
    FirstHits::trace(&tracer, &BaseColor(scene.clone()), focus, camera, &Unwatched).unwrap()
}

/// The light field of `camera` for `focus`.
pub fn light_field(scene: &Arc<Scene>, camera: &Camera, focus: &ByPart) -> Arc<Salf> {
    let tracer = Tracer::new(scene.clone());
    let options = BakeOptions::for_focus(&tracer, camera, focus);
    Arc::new(salf::bake(&tracer, &BaseColor(scene.clone()), camera, &options, &Unwatched).unwrap())
}

/// The light field's picture by splatting.
pub fn splatted(scene: &Arc<Scene>, camera: &Camera, focus: &ByPart) -> Picture {
    let mut splatter = splat::Splatter::new(light_field(scene, camera, focus));
    splatter.render(camera, focus, &Unwatched).unwrap();
    splatter.picture().clone()
}

/// The ordinary lens for all of `scene`.
pub fn unpainted(scene: &Arc<Scene>) -> ByPart {
    ByPart(scene.clone(), vec![FocusOffset::STANDARD])
}

/// The sum of the green channel, in pixels of radiance 1.
pub fn energy(picture: &Picture) -> f64 {
    picture.radiance.iter().map(|rgb| f64::from(rgb[1])).sum()
}

/// The radius of the disc that has the picture's second moment, px.
pub fn disc_radius(picture: &Picture) -> f64 {
    let (mut first, mut second) = (DVec2::ZERO, 0.0);
    for (k, rgb) in picture.radiance.iter().enumerate() {
        let (x, y) = (k % picture.width as usize, k / picture.width as usize);
        let position = DVec2::new(x as f64, y as f64) + 0.5;
        first += f64::from(rgb[1]) * position;
        second += f64::from(rgb[1]) * position.length_squared();
    }
    let energy = energy(picture);
    (2.0 * (second / energy - (first / energy).length_squared())).sqrt()
}

/// The same work on one thread and on three.
pub fn on_few_and_many_threads<T: Send>(work: impl Fn() -> T + Sync) -> [T; 2] {
    [1, 3].map(|count| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(&work)
    })
}

/// A watcher that no longer wants the result.
pub struct Unwanted;

impl Progress for Unwanted {
    fn report(&self, _fraction: f32) {}
    fn cancelled(&self) -> bool {
        true
    }
}
