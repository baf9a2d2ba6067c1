//! The clearcoat, which lies over all other layers and may have a normal map of its own (KHR_materials_clearcoat's
//! normal texture).

use super::{Bsdf, OutgoingFrame, Scattered, half, mirror};
use crate::Split;
use crate::albedo::Gloss;
use crate::fresnel::rise;
use glam::{DVec2, DVec3};

/// The reflectance of a coat of index 1.5 at normal incidence.
const COAT_F0: f64 = 0.04;

impl Bsdf<'_> {
    /// The coat's albedo toward a direction in its own axes.
    pub(super) fn coat_albedo(&self, w: DVec3) -> f64 {
        let Some(coat) = self.surface.clearcoat else { return 0.0 };
        let shares = if self.coat.is_smooth() {
            DVec2::new(1.0 - rise(w.z.abs()), rise(w.z.abs()))
        } else {
            Gloss { roughness: coat.roughness, anisotropy: 0.0 }.shares(w)
        };
        coat.factor * (COAT_F0 * shares.x + shares.y)
    }

    /// The value of a rough coat, 1/sr: its own cosine over that of the frame, which is applied elsewhere.
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

    /// Samples an incident direction from a rough coat.
    pub(super) fn sample_coat(&self, view: &OutgoingFrame, u: DVec2) -> DVec3 {
        let of_eye = view.coat.local(view.o);
        view.coat.back(mirror(of_eye, self.coat.visible_normal(of_eye, u)))
    }

    /// The density of [`Self::sample_coat`], 1/sr; 0 for a smooth coat.
    pub(super) fn density_of_coat(&self, view: &OutgoingFrame, i: DVec3) -> f64 {
        if self.coat.is_smooth() {
            return 0.0;
        }
        let [of_eye, of_light] = [view.o, i].map(|w| view.coat.local(w));
        half(of_eye, of_light)
            .map_or(0.0, |h| self.coat.density_of_visible(of_eye, h) / (4.0 * of_eye.dot(h)))
    }

    /// The mirror direction of a smooth coat, sampled with this probability.
    pub(super) fn mirrored_by_coat(&self, view: &OutgoingFrame, probability: f64) -> Option<Scattered> {
        let of_eye = view.coat.local(view.o);
        let weight = DVec3::splat(self.coat_albedo(of_eye) / probability);
        let i = view.coat.back(mirror(of_eye, DVec3::Z));
        // A normal map may turn it into the surface: that light is lost.
        if i.z > 0.0 { self.single(view, i, Split::carried(weight)) } else { None }
    }
}
