//! Glass: reflection, transmission, and the multiple scattering on its facets.

use super::{Bsdf, OutgoingFrame, Scattered, cosine_weighted, flipped, half};
use crate::Split;
use crate::fresnel::dielectric_reflectance;
use crate::ggx::Ggx;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_1_PI, TAU};

/// Multiple scattering on rough glass as seen from one side: what single scattering loses, and the share of it that returns on that
/// side.
#[derive(Clone, Copy, Debug)]
pub(super) struct MultipleScattering {
    /// The share that single scattering sends to neither side.
    pub lost: f64,
    /// The share of the lost light that returns on the outgoing side.
    pub stays: f64,
}

impl Bsdf<'_> {
    /// Reflection by rough glass.
    pub(super) fn glass(&self, view: &OutgoingFrame, o: DVec3, i: DVec3) -> Split {
        let (share, eta) = (self.shares[2], self.eta(view));
        if share == 0.0 || self.is_clear(eta) {
            return Split::default();
        }
        let single = half(o, i)
            .map_or(0.0, |h| dielectric_reflectance(o.dot(h), eta) * self.microfacets(&self.ggx, o, i, h));
        let stays = self.glass_returned(view, i);
        (Split::mirrored(DVec3::splat(single), self.ggx.mean_alpha()) + Split::own(DVec3::splat(stays)))
            * share
    }

    /// Transmission by rough glass.
    pub(super) fn across(&self, view: &OutgoingFrame, o: DVec3, i: DVec3) -> Split {
        let (share, eta) = (self.shares[2], self.eta(view));
        if share == 0.0 || self.is_clear(eta) {
            return Split::default();
        }
        let single = match self.surface.is_thin {
            true => half(o, flipped(i)).map_or(0.0, |h| {
                (1.0 - dielectric_reflectance(o.dot(h), eta)) * self.microfacets(&self.ggx, o, flipped(i), h)
            }),
            false => through_facets(&self.ggx, o, i, eta),
        };
        let crosses = self.glass_returned(view, i);
        Split::carried(self.surface.base_color * (single + crosses)) * share
    }

    /// The density, 1/sr, with which single scattering samples light from the other side.
    pub(super) fn density_across(&self, view: &OutgoingFrame, i: DVec3) -> f64 {
        let (o, eta) = (view.o, self.eta(view));
        if !self.surface.is_thin {
            return density_through(&self.ggx, o, i, eta);
        }
        half(o, flipped(i)).map_or(0.0, |h| {
            let crosses = 1.0 - dielectric_reflectance(o.dot(h), eta);
            crosses * self.ggx.density_of_visible(o, h) / (4.0 * o.dot(h))
        })
    }

    /// The share that single scattering loses toward the eye, and how much of that returns on its side.
    pub(super) fn glass_lost(&self, view: &OutgoingFrame) -> MultipleScattering {
        let eta = self.eta(view);
        if self.shares[2] == 0.0 || self.is_clear(eta) {
            return MultipleScattering { lost: 0.0, stays: 1.0 };
        }
        match &self.rough_glass {
            Some(glass) => MultipleScattering {
                lost: glass.side(view.from_front).lost(view.o.z),
                stays: glass.returned_share(view.from_front),
            },
            None => {
                MultipleScattering { lost: self.lost(self.gloss_shares(view.o)), stays: dielectric_mean(eta) }
            }
        }
    }

    /// The distribution of the lost light over incident directions, 1/sr: (1 − E(i))/(π(1 − Ē)) on that side.
    fn spread_of_lost(&self, view: &OutgoingFrame, i: DVec3) -> f64 {
        let (lost, mean) = match &self.rough_glass {
            Some(glass) => {
                let row = glass.side(view.from_front == (i.z > 0.0));
                (row.lost(i.z.abs()), row.mean_lost())
            }
            None => (self.lost(self.gloss_shares(i)), self.lost(self.mean_gloss_shares())),
        };
        if lost > 0.0 && mean > 0.0 { lost * FRAC_1_PI / mean } else { 0.0 }
    }

    /// The multiple-scattering lobe of glass, on the outgoing side or through the surface.
    fn glass_returned(&self, view: &OutgoingFrame, i: DVec3) -> f64 {
        let MultipleScattering { lost, stays } = self.glass_lost(view);
        if lost == 0.0 {
            return 0.0;
        }
        // Radiance is n² as large on the other side.
        let (share, scale) = match (i.z > 0.0, self.surface.is_thin) {
            (true, _) => (stays, 1.0),
            (false, true) => (1.0 - stays, 1.0),
            (false, false) => (1.0 - stays, self.eta(view).powi(2)),
        };
        share * lost * self.spread_of_lost(view, i) / scale
    }

    /// Samples an incident direction of the lost light, and whether it crosses the surface; `which` and `u` are
    /// uniform.
    pub(super) fn sample_returned(&self, view: &OutgoingFrame, which: f64, u: DVec2) -> (DVec3, bool) {
        let crosses = which >= self.glass_lost(view).stays;
        let Some(glass) = &self.rough_glass else {
            let i = cosine_weighted(u);
            return (if crosses { flipped(i) } else { i }, crosses);
        };
        let cos = glass.side(view.from_front != crosses).cosine_of_lost(u.y);
        let (sin, around) = (TAU * u.x).sin_cos();
        let flat = (1.0 - cos * cos).max(0.0).sqrt();
        (DVec3::new(flat * around, flat * sin, if crosses { -cos } else { cos }), crosses)
    }

    /// The density of [`Self::sample_returned`], 1/sr.
    pub(super) fn density_of_returned(&self, view: &OutgoingFrame, i: DVec3) -> f64 {
        let stays = self.glass_lost(view).stays;
        let share = if i.z > 0.0 { stays } else { 1.0 - stays };
        let spread = if self.rough_glass.is_none() { FRAC_1_PI } else { self.spread_of_lost(view, i) };
        share * spread * i.z.abs()
    }

    /// The albedo of glass on the outgoing side.
    pub(super) fn glass_mirrors(&self, view: &OutgoingFrame) -> f64 {
        let eta = self.eta(view);
        if self.shares[2] == 0.0 || self.is_clear(eta) {
            return dielectric_reflectance(view.o.z, eta);
        }
        let MultipleScattering { lost, stays } = self.glass_lost(view);
        let mirrored = match &self.rough_glass {
            Some(glass) => glass.side(view.from_front).mirrored(view.o.z),
            None => self.interface.rough(self.surface.roughness).side(true).mirrored(view.o.z),
        };
        mirrored + lost * stays
    }

    /// A sample of clear glass, drawn with `probability`.
    pub(super) fn clear(
        &self,
        view: &OutgoingFrame,
        probability: f64,
        is_mirrored: bool,
        i: DVec3,
    ) -> Option<Scattered> {
        let scale = self.shares[2] * self.beneath(&view.side, &self.side(i, &view.coat)) / probability;
        let weight = match is_mirrored {
            true => DVec3::splat(scale),
            false if self.surface.is_thin => self.surface.base_color * scale,
            false => self.surface.base_color * scale / self.eta(view).powi(2),
        };
        self.single(view, i, Split::carried(weight))
    }
}

/// The facet that refracts light from `i` toward `o`: −(o + η i), on `o`'s side.
fn refracting(o: DVec3, i: DVec3, eta: f64) -> Option<DVec3> {
    let h = (o + eta * i).try_normalize()?;
    let h = if h.z < 0.0 { -h } else { h };
    (o.dot(h) > 0.0 && i.dot(h) < 0.0).then_some(h)
}

/// Transmission through rough glass by single scattering (Walter et al. 2007, equation 21), for radiance.
fn through_facets(ggx: &Ggx, o: DVec3, i: DVec3, eta: f64) -> f64 {
    let Some(h) = refracting(o, i, eta) else { return 0.0 };
    let (from, to) = (o.dot(h), i.dot(h));
    let crosses = 1.0 - dielectric_reflectance(from, eta);
    let facet_density = ggx.uncorrelated_masking_shadowing(o, flipped_up(i)) * ggx.density_of_normals(h);
    let value = (from * to / (o.z * i.z)).abs() * crosses * facet_density / (from + eta * to).powi(2);
    // Equal media do not refract: all normals transmit alike, and the lobe is a single direction.
    if value.is_finite() { value } else { 0.0 }
}

fn density_through(ggx: &Ggx, o: DVec3, i: DVec3, eta: f64) -> f64 {
    let Some(h) = refracting(o, i, eta) else { return 0.0 };
    let (from, to) = (o.dot(h), i.dot(h));
    let crosses = 1.0 - dielectric_reflectance(from, eta);
    let density = crosses * ggx.density_of_visible(o, h) * eta * eta * to.abs() / (from + eta * to).powi(2);
    if density.is_finite() { density } else { 0.0 }
}

/// The mean reflectance of a smooth dielectric over the cosine-weighted hemisphere.
fn dielectric_mean(eta: f64) -> f64 {
    const STEPS: usize = 32;
    let step = |k: usize| dielectric_reflectance(((k as f64 + 0.5) / STEPS as f64).sqrt(), eta);
    (0..STEPS).map(step).sum::<f64>() / STEPS as f64
}

/// The direction on the side that the normal points to.
fn flipped_up(w: DVec3) -> DVec3 {
    DVec3::new(w.x, w.y, w.z.abs())
}
