//! The coat, which lies over all and may have bumps of its own (KHR_materials_clearcoat's normal texture).

use super::{Bsdf, OutgoingFrame, Scattered, half, mirror};
use crate::Split;
use crate::albedo::Gloss;
use crate::fresnel::rise;
use glam::{DVec2, DVec3};

/// What a coat of index 1.5 mirrors of light that falls on it straight.
const COAT_F0: f64 = 0.04;

impl Bsdf<'_> {
    /// What it mirrors in all toward a direction of its own axes.
    pub(super) fn coat_albedo(&self, w: DVec3) -> f64 {
        let Some(coat) = self.surface.clearcoat else { return 0.0 };
        let shares = if self.coat.is_smooth() {
            DVec2::new(1.0 - rise(w.z.abs()), rise(w.z.abs()))
        } else {
            Gloss { roughness: coat.roughness, anisotropy: 0.0 }.shares(w)
        };
        coat.factor * (COAT_F0 * shares.x + shares.y)
    }

    /// What a rough one mirrors, 1/sr: by its own cosine over that of the frame, which is counted elsewhere.
    pub(super) fn coated(&self, view: &OutgoingFrame, i: DVec3) -> Split {
        let Some(coat) = self.surface.clearcoat.filter(|_| !self.coat.is_smooth()) else {
            return Split::default();
        };
        let [of_eye, of_light] = [view.o, i].map(|w| view.coat.local(w));
        if of_eye.z <= 0.0 || of_light.z <= 0.0 {
            return Split::default();
        }
        let Some(h) = half(of_eye, of_light) else { return Split::default() };
        let mirrored = COAT_F0 + (1.0 - COAT_F0) * rise(of_eye.dot(h));
        let facets = self.microfacets(&self.coat, of_eye, of_light, h) * (of_light.z / i.z);
        Split::mirrored(DVec3::splat(coat.factor * mirrored * facets), self.coat.mean_alpha())
    }

    /// A direction that a rough one mirrors toward the eye.
    pub(super) fn sample_coat(&self, view: &OutgoingFrame, u: DVec2) -> DVec3 {
        let of_eye = view.coat.local(view.o);
        view.coat.back(mirror(of_eye, self.coat.visible_normal(of_eye, u)))
    }

    /// How likely that is, 1/sr; 0 of a smooth one.
    pub(super) fn density_of_coat(&self, view: &OutgoingFrame, i: DVec3) -> f64 {
        if self.coat.is_smooth() {
            return 0.0;
        }
        let [of_eye, of_light] = [view.o, i].map(|w| view.coat.local(w));
        half(of_eye, of_light)
            .map_or(0.0, |h| self.coat.density_of_visible(of_eye, h) / (4.0 * of_eye.dot(h)))
    }

    /// What a smooth one mirrors, drawn with these odds.
    pub(super) fn mirrored_by_coat(&self, view: &OutgoingFrame, probability: f64) -> Option<Scattered> {
        let of_eye = view.coat.local(view.o);
        let weight = DVec3::splat(self.coat_albedo(of_eye) / probability);
        let i = view.coat.back(mirror(of_eye, DVec3::Z));
        // Bumps may turn it into what lies beneath: it is lost.
        if i.z > 0.0 { self.single(view, i, Split::carried(weight)) } else { None }
    }
}
