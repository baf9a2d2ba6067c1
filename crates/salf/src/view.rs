//! The baked camera, ready for rays: pixels to chief rays, aperture points to the world.

use crate::carried::Carried;
use glam::{DVec2, DVec3};
use lens::{ApertureSampler, Camera, Optics};
use scene::Scene;
use trace::{Beam, Ray, Square};

/// A camera with its axes in the world.
pub struct View<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// Its optics: how it focuses.
    pub optics: Optics,
    /// Draws places of the aperture that light passes.
    pub open_aperture: ApertureSampler,
    /// The aperture's centre.
    pub eye: DVec3,
    right: DVec3,
    up: DVec3,
    /// Splat radius in px for κ = 1: half the side of the aperture square as seen from a point.
    pub radius_per_kappa_px: f64,
    /// How large a cell of a partly visible aperture may be on the picture, px.
    pub tolerance_px: f64,
    /// How finely carried light is sampled.
    pub carried: Carried,
}

impl<'a> View<'a> {
    /// The view of a camera, in which positions may be wrong by `tolerance_px`.
    pub fn new(camera: &'a Camera, tolerance_px: f64) -> Self {
        let optics = camera.optics();
        Self {
            camera,
            optics,
            open_aperture: ApertureSampler::new(&camera.aperture),
            eye: camera.position(),
            right: camera.world_direction(DVec3::X),
            up: camera.world_direction(DVec3::Y),
            radius_per_kappa_px: optics.splat_radius_px(1.0),
            tolerance_px,
            carried: Carried::Standard,
        }
    }

    /// The same view with this resolution of carried light.
    pub fn with_carried(self, carried: Carried) -> Self {
        Self { carried, ..self }
    }

    /// The chief ray (world) through a pixel position; its t is the depth z in scene units.
    #[inline]
    pub fn chief_ray(&self, pixel: DVec2) -> Ray {
        let q = self.camera.q_from_pixel(pixel) * self.optics.tan_half_yfov;
        let direction = self.camera.world_direction(q.extend(1.0));
        Ray { origin: self.eye, direction, t_min: 0.0, t_max: f64::INFINITY, skip: None }
    }

    /// The chief rays of a square of the picture: its upper left corner and its side, px.
    pub fn beam(&self, corner: DVec2, side: f64) -> Beam {
        let edges = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y]
            .map(|step| self.chief_ray(corner + step * side).direction);
        Beam { origin: self.eye, axis: self.camera.world_direction(DVec3::Z), edges }
    }

    /// The world position of the aperture point R·u; `u` in [−1, 1]².
    pub fn aperture_point(&self, u: DVec2) -> DVec3 {
        self.eye + self.optics.aperture_radius * (u.x * self.right + u.y * self.up)
    }

    /// The square around the aperture.
    pub fn aperture_square(&self) -> Square {
        let radius = self.optics.aperture_radius;
        Square { center: self.eye, right: radius * self.right, up: radius * self.up }
    }

    /// The diameter, px, of the circle of confusion that the unpainted lens makes of a point with this inverse depth
    /// (1/length).
    pub fn circle_px(&self, inverse_depth: f64) -> f64 {
        self.optics.circle_of_confusion_px(self.optics.standard_kappa(inverse_depth))
    }

    /// The weight of a surface at depth `z`, px², for each unit of its area and of n·(U − P): 1/(z³ tan²θ) in pixels.
    pub fn density(&self, z: f64) -> f64 {
        let scale = self.optics.half_height_px / self.optics.tan_half_yfov;
        scale * scale / z.powi(3)
    }

    /// How the weight of a surface with `normal` through `point` changes over the aperture, as a share of its
    /// weight at the centre: w(u)/w(0) = n·(P − U)/n·P = 1 + tilt·u. Unbounded where the plane passes
    /// through the aperture's centre.
    pub fn relative_tilt(&self, normal: DVec3, point: DVec3) -> DVec2 {
        let radius = self.optics.aperture_radius;
        DVec2::new(normal.dot(self.right), normal.dot(self.up)) * (-radius / normal.dot(point - self.eye))
    }

    /// Whether the aperture is well on one side of a triangle's plane, so that the pinhole picture samples it
    /// well: its weight changes by at most three quarters over the aperture. Else it is nearly edge-on.
    pub fn faces_aperture(&self, scene: &Scene, triangle: u32) -> bool {
        let tilt = self.relative_tilt(scene.area_normal(triangle), scene.corners(triangle)[0]);
        tilt.x.abs() + tilt.y.abs() <= 0.75
    }
}
