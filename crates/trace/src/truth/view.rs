//! The scene, focus and camera of a render. The only place where focus becomes κ.

use super::ray_focus::RayFocus;
use crate::Tracer;
use glam::{DVec2, DVec3};
use lens::{Camera, FocusOffset, Optics};
use scene::{SurfaceField, SurfacePoint};

/// Scene, focus and camera.
pub(super) struct View<'a> {
    pub tracer: &'a Tracer,
    pub focus: &'a dyn SurfaceField<FocusOffset>,
    /// In place of `focus`.
    pub ray_focus: Option<&'a dyn RayFocus>,
    pub camera: &'a Camera,
    pub optics: Optics,
}

/// How the light of a ray is focused: by whose it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blurs {
    /// That of own light.
    pub own: Blur,
    /// That of carried light.
    pub carried: Blur,
}

/// How light is focused.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blur {
    /// κ.
    pub kappa: f64,
    /// Whether κ is exactly the unpainted lens's.
    pub is_standard: bool,
}

impl View<'_> {
    /// κ of the light of a ray from `point` (`None`: the background) of depth 1/`inverse_depth` through the aperture
    /// point `u`, scene units.
    pub fn blurs(&self, point: Option<SurfacePoint>, inverse_depth: f64, u: DVec2) -> Blurs {
        let painted = |focus: FocusOffset| Blur {
            kappa: self.optics.kappa(inverse_depth, focus),
            is_standard: focus.is_standard(),
        };
        if let Some(ray_focus) = self.ray_focus {
            let radius = self.optics.aperture_radius;
            let within = if radius > 0.0 { u / radius } else { DVec2::ZERO };
            let ray = ray_focus.optics(point, within);
            let (inverse_f, distance) = (ray.inverse_focal_length, ray.transmission_distance);
            let kappa = self.optics.kappa_of_ray(inverse_depth, inverse_f, distance);
            return Blurs {
                own: Blur { kappa, is_standard: false },
                carried: painted(FocusOffset::STANDARD),
            };
        }
        let focus = point.map_or_else(|| self.focus.at_infinity(), |point| self.focus.at(point));
        Blurs { own: painted(focus), carried: painted(focus.of_carried()) }
    }

    /// How far from its standard place a ray of this blur lands, px, x right, y down.
    pub fn displacement_px(&self, blur: Blur, inverse_depth: f64, u: DVec2) -> DVec2 {
        if blur.is_standard {
            return DVec2::ZERO;
        }
        let kappa = blur.kappa - self.optics.standard_kappa(inverse_depth);
        let q = kappa * u / self.optics.tan_half_yfov;
        DVec2::new(q.x, -q.y) * self.optics.half_height_px
    }

    /// Where the ray from `position` (camera space, z > 0) through the aperture point `u`, in [−1, 1]², lands with a
    /// defocus `kappa` (1/length); px.
    pub fn landing_px(&self, position: DVec3, u: DVec2, kappa: f64) -> DVec2 {
        self.camera.pixel_from_q(self.optics.landing(position, u, kappa))
    }

    /// The radius of the circle of confusion of a defocus κ (1/length), px; never negative.
    pub fn radius_px(&self, kappa: f64) -> f64 {
        self.optics.splat_radius_px(kappa).abs()
    }
}
