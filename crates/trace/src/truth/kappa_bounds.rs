//! Between which bounds κ lies, for all points of a piece of surface.

use super::options::Sampler;
use super::samples::point;
use super::view::View;
use glam::DVec2;
use lens::FocusOffset;
use scene::{SurfaceField, SurfacePoint};

/// The corners of a box of values of whatever decides focus: t and anchor, or 1/f and T. κ, κ·z and κ − κ of
/// the unpainted lens are linear in each of these numbers and in 1/z (or z) by itself, so that their extremes
/// over a box and a range of depths lie at corners: bounds that are reached.
#[derive(Clone, Copy, Debug)]
pub(super) enum FocusBox {
    /// Of a painted focus: the least and the greatest t and anchor, also of carried light where paint moves it.
    Painted([FocusOffset; 2]),
    /// Of a focus by rays.
    ByRay([super::ray_focus::RayOptics; 2]),
}

impl FocusBox {
    /// The box of the focus of all points of a triangle, given by its index in the scene.
    pub fn of_triangle(view: &View, triangle: u32) -> Self {
        match view.ray_focus {
            Some(rays) => Self::ByRay(rays.bounds()),
            None => Self::painted(
                view.focus.bounds(triangle).unwrap_or_else(|| sampled_bounds(view.focus, triangle)),
            ),
        }
    }

    /// The box of the background's focus.
    pub fn of_background(view: &View) -> Self {
        match view.ray_focus {
            Some(rays) => Self::ByRay(rays.bounds()),
            None => Self::painted([view.focus.at_infinity(); 2]),
        }
    }

    /// Of a painted focus between bounds. Its carried light has a t' and an a' that are linear in t, anchor and gloss, each by
    /// itself: their extremes lie at corners, too.
    fn painted(bounds: [FocusOffset; 2]) -> Self {
        let glosses = bounds.map(|bound| bound.gloss);
        if glosses == [0.0; 2] {
            return Self::Painted(bounds);
        }
        let carried =
            bounds.into_iter().flat_map(|bound| glosses.map(|gloss| bound.with_gloss(gloss).of_carried()));
        Self::Painted(carried.fold(bounds, extended))
    }

    /// κ at its corners.
    fn corners(&self, view: &View, inverse_depth: f64) -> [f64; 4] {
        const CORNERS: [(usize, usize); 4] = [(0, 0), (0, 1), (1, 0), (1, 1)];
        match self {
            Self::Painted(bounds) => CORNERS.map(|(i, j)| {
                view.optics.kappa(inverse_depth, FocusOffset::new(bounds[i].t, bounds[j].anchor))
            }),
            Self::ByRay(bounds) => CORNERS.map(|(i, j)| {
                let (inverse_f, distance) = (bounds[i].inverse_focal_length, bounds[j].transmission_distance);
                view.optics.kappa_of_ray(inverse_depth, inverse_f, distance)
            }),
        }
    }

    /// The largest |t·(1 − a)|, by which the field's curvature counts.
    fn curving(&self) -> f64 {
        match self {
            Self::Painted(bounds) => {
                let t = bounds.iter().fold(0.0, |most: f64, focus| most.max(focus.t.abs()));
                let anchor = bounds.iter().fold(1.0, |least: f64, focus| least.min(focus.anchor));
                t * (1.0 - anchor)
            }
            Self::ByRay(_) => 0.0,
        }
    }

    /// What a lens's character adds to |κ| at most, 1/length, for points up to `chief` half-heights from the axis.
    fn character_kappa(&self, view: &View, chief: f64) -> f64 {
        view.largest_character_kappa(chief, self.curving())
    }

    /// The largest defocus |κ|, 1/length, at depths whose reciprocals lie between both `inverse_depths`, up to `chief` half-heights from
    /// the axis.
    pub fn largest_kappa(&self, view: &View, inverse_depths: [f64; 2], chief: f64) -> f64 {
        let plain =
            largest(inverse_depths.into_iter().flat_map(|inverse_depth| self.corners(view, inverse_depth)));
        plain + self.character_kappa(view, chief)
    }

    /// The largest radius of the background's aperture images that may reach `window`, px.
    pub fn background_radius_px(&self, view: &View, window: [DVec2; 2]) -> f64 {
        let plain = view.radius_px(self.largest_kappa(view, [0.0; 2], 0.0));
        let chief = view.farthest_background(window, plain, self.curving());
        view.radius_px(self.largest_kappa(view, [0.0; 2], chief))
    }

    /// How far the background's light that may reach `window` is displaced at most, px.
    pub fn background_displacement_px(&self, view: &View, window: [DVec2; 2]) -> f64 {
        let chief = view.farthest_background(window, self.background_radius_px(view, window), self.curving());
        view.radius_px(self.largest_displacement(view, [0.0; 2], chief))
    }

    /// The largest |κ − κ_standard| for such points, κ_standard that of a lens without character; exactly 0 if nothing is painted and the
    /// lens has none.
    pub fn largest_displacement(&self, view: &View, inverse_depths: [f64; 2], chief: f64) -> f64 {
        let character = self.character_kappa(view, chief);
        if let Self::Painted(bounds) = self
            && bounds.iter().all(|focus| focus.is_standard())
        {
            return character;
        }
        character
            + largest(inverse_depths.into_iter().flat_map(|inverse_depth| {
                let standard = view.optics.standard_kappa(inverse_depth);
                self.corners(view, inverse_depth).map(|kappa| kappa - standard)
            }))
    }

    /// The largest |κ·z|, without unit, for depths in (0, `depth`]: finite although κ is not.
    pub fn largest_kappa_times_depth(&self, view: &View, depth: f64, chief: f64) -> f64 {
        let [at_depth, at_half] = [depth, depth / 2.0].map(|z| self.corners(view, 1.0 / z).map(|k| k * z));
        // A straight line in z, whose value at 0 follows from two others.
        let at_zero = (0..4).map(|k| 2.0 * at_half[k] - at_depth[k]);
        largest(at_depth.into_iter().chain(at_zero)) + depth * self.character_kappa(view, chief)
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest, value| largest.max(value.abs()))
}

/// Bounds of a field that has none of its own: those of samples at the corners and inside, widened by a share of
/// their range.
fn sampled_bounds(focus: &dyn SurfaceField<FocusOffset>, triangle: u32) -> [FocusOffset; 2] {
    const SAMPLES: u64 = 29;
    const BEYOND: f64 = 0.25;
    let within = (0..SAMPLES).map(|k| {
        let [x, y, ..] = point(Sampler::LowDiscrepancy, 0, k);
        uniform_barycentric(DVec2::new(x, y))
    });
    let at = |barycentric| focus.at(SurfacePoint { triangle, barycentric });
    let sampled = [DVec2::ZERO, DVec2::X, DVec2::Y].into_iter().chain(within).map(at);
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let none = none.map(|none| FocusOffset::new(none, none).with_gloss(none));
    let [least, greatest] = sampled.fold(none, extended);
    let beyond = |of: fn(FocusOffset) -> f64| (of(greatest) - of(least)) * BEYOND;
    let (t, anchor, gloss) = (beyond(|f| f.t), beyond(|f| f.anchor), beyond(|f| f.gloss));
    [
        FocusOffset::new(least.t - t, (least.anchor - anchor).max(0.0))
            .with_gloss((least.gloss - gloss).max(0.0)),
        FocusOffset::new(greatest.t + t, (greatest.anchor + anchor).min(1.0))
            .with_gloss((greatest.gloss + gloss).min(1.0)),
    ]
}

/// Bounds that hold one more.
fn extended([least, greatest]: [FocusOffset; 2], focus: FocusOffset) -> [FocusOffset; 2] {
    [
        FocusOffset::new(least.t.min(focus.t), least.anchor.min(focus.anchor))
            .with_gloss(least.gloss.min(focus.gloss)),
        FocusOffset::new(greatest.t.max(focus.t), greatest.anchor.max(focus.anchor))
            .with_gloss(greatest.gloss.max(focus.gloss)),
    ]
}

/// The unit square onto the triangle, area for area (Heitz 2019).
pub(super) fn uniform_barycentric(u: DVec2) -> DVec2 {
    if u.y > u.x { DVec2::new(0.5 * u.x, u.y - 0.5 * u.x) } else { DVec2::new(u.x - 0.5 * u.y, 0.5 * u.y) }
}
