//! One sample: a standard camera's ray, what it hits, and how far from its own pixel that lands.

use crate::{Ray, Tracer};
use glam::{DVec2, DVec3};
use lens::{Camera, FocusOffset, Optics};
use scene::{SurfaceField, SurfacePoint};

/// Makes and traces the rays of a camera.
pub(super) struct SampleRays<'a> {
    pub tracer: &'a Tracer,
    pub focus: &'a dyn SurfaceField<FocusOffset>,
    pub camera: &'a Camera,
    pub optics: Optics,
}

/// What a ray found.
pub(super) struct Sample {
    /// The surface point, `None` for the background.
    pub point: Option<SurfacePoint>,
    /// The aperture point in the world.
    pub eye: DVec3,
    /// The direction from there, in the world.
    pub direction: DVec3,
    /// Where it lands, less where it left: px, x right, y down.
    pub displacement_px: DVec2,
}

impl<'a> SampleRays<'a> {
    pub fn new(tracer: &'a Tracer, focus: &'a dyn SurfaceField<FocusOffset>, camera: &'a Camera) -> Self {
        Self { tracer, focus, camera, optics: camera.optics() }
    }

    /// Traces the ray that passes the picture at `pixel` and the aperture at `u`.
    pub fn trace(&self, pixel: DVec2, u: DVec2) -> Sample {
        let optics = &self.optics;
        let p = self.camera.q_from_pixel(pixel);
        // Toward the point that p shows on the focus plane; of depth 1, so that t is the depth z.
        let slope = p * optics.tan_half_yfov - u * optics.inverse_focus_distance;
        let eye = self.camera.world_from_camera(u.extend(0.0));
        let direction = self.camera.world_direction(slope.extend(1.0));
        let ray = Ray { origin: eye, direction, t_min: 0.0, t_max: f64::INFINITY, skip: None };
        let hit = self.tracer.first_hit(&ray);
        let (inverse_depth, focus) = match &hit {
            Some(hit) => (1.0 / hit.t, self.focus.at(hit.point)),
            None => (0.0, self.focus.at_infinity()),
        };
        let displacement_px = if focus.is_standard() {
            DVec2::ZERO
        } else {
            let displacement = optics.kappa(inverse_depth, focus) - optics.standard_kappa(inverse_depth);
            let q = displacement * u / optics.tan_half_yfov;
            DVec2::new(q.x, -q.y) * optics.half_height_px
        };
        Sample { point: hit.map(|hit| hit.point), eye, direction, displacement_px }
    }
}
