//! The scene, focus and camera of a render. The only place where focus becomes κ.

use super::ray_focus::RayFocus;
use crate::Tracer;
use glam::{DVec2, DVec3};
use lens::{CHANNELS, Camera, CharacterOptics, FocusOffset, GREEN, Optics};
use scene::{SurfaceField, SurfacePoint};

/// Scene, focus and camera.
pub(super) struct View<'a> {
    pub tracer: &'a Tracer,
    pub focus: &'a dyn SurfaceField<FocusOffset>,
    /// In place of `focus`.
    pub ray_focus: Option<&'a dyn RayFocus>,
    pub camera: &'a Camera,
    /// The lens without character.
    pub optics: Optics,
    /// The lens's character, if it changes where light lands or what it weighs.
    pub character: Option<CharacterOptics>,
}

/// Where a ray comes from, as the lens sees it, and where it crosses the aperture.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayPlace {
    /// The chief place of its point, half-heights from the axis.
    pub chief: DVec2,
    /// 1/z.
    pub inverse_depth: f64,
    /// The aperture point, scene units.
    pub u: DVec2,
}

/// Where light of some colours lands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arrival {
    /// Where, px.
    pub at: DVec2,
    /// What each colour weighs there.
    pub colours: DVec3,
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

impl<'a> View<'a> {
    /// The view of a camera through a lens of its character.
    pub fn new(tracer: &'a Tracer, focus: &'a dyn SurfaceField<FocusOffset>, camera: &'a Camera) -> Self {
        let character = &camera.character;
        let is_plain =
            !character.has_fringe() && !character.shapes_discs() && character.field_curvature == 0.0;
        let character = (!is_plain).then(|| camera.character_optics());
        Self { tracer, focus, ray_focus: None, camera, optics: camera.optics(), character }
    }
}

impl View<'_> {
    /// κ, green's, of the light of a ray from `point` (`None`: the background).
    pub fn blurs(&self, point: Option<SurfacePoint>, place: RayPlace) -> Blurs {
        let RayPlace { chief, inverse_depth, u } = place;
        let optics = self.character.map_or(self.optics, |character| character.at(chief));
        let painted = |focus: FocusOffset| Blur {
            kappa: optics.kappa(inverse_depth, focus),
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

    /// Where a ray's light of this blur lands through a lens of character, and what it weighs there: in one place, or each colour in
    /// its own.
    pub fn arrivals(
        &self,
        character: &CharacterOptics,
        place: RayPlace,
        blur: Blur,
    ) -> impl Iterator<Item = Arrival> + use<> {
        let defocus = character.colour_defocus();
        let arrival = |channel: usize| {
            let kappa = blur.kappa + defocus[channel];
            let q = character.landing(place.chief, place.u, kappa, channel);
            (self.camera.pixel_from_q(q), character.edges.weight(place.u, kappa))
        };
        let mut arrivals = [None; CHANNELS];
        if character.has_fringe() {
            for (channel, slot) in arrivals.iter_mut().enumerate() {
                let (at, weight) = arrival(channel);
                *slot = Some(Arrival { at, colours: DVec3::AXES[channel] * weight });
            }
        } else {
            let (at, weight) = arrival(GREEN);
            arrivals[GREEN] = Some(Arrival { at, colours: DVec3::splat(weight) });
        }
        arrivals.into_iter().flatten()
    }

    /// How far apart colours land at most in a window of the picture (its least and greatest corner, px), px.
    pub fn lateral_px(&self, window: [DVec2; 2]) -> f64 {
        let Some(character) = &self.character else { return 0.0 };
        let lateral = character.largest_lateral();
        lateral / (1.0 - lateral) * self.farthest_from_axis_px(window)
    }

    /// The largest distance of a window's corners from the axis, px.
    fn farthest_from_axis_px(&self, [low, high]: [DVec2; 2]) -> f64 {
        let axis = self.camera.principal_point_px();
        (low - axis).abs().max((high - axis).abs()).length()
    }

    /// What character adds to |κ| at most, 1/length, up to `chief` half-heights from the axis, where the field curves by up to
    /// `curving` times as much as the unpainted (|t·(1 − a)|).
    pub fn largest_character_kappa(&self, chief: f64, curving: f64) -> f64 {
        self.character.map_or(0.0, |character| {
            curving * character.largest_curvature(chief) + character.largest_colour_defocus()
        })
    }

    /// How far from the axis, half-heights, light of infinity may come from that lands in a window with a radius of `radius` px, where
    /// the field curves by up to `curving` times as much.
    pub fn farthest_background(&self, window: [DVec2; 2], radius: f64, curving: f64) -> f64 {
        let corner = (self.farthest_from_axis_px(window) + radius) / self.optics.half_height_px;
        (0..8).fold(corner, |chief, _| {
            let more = self.radius_px(self.largest_character_kappa(chief, curving));
            corner + more / self.optics.half_height_px
        })
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
