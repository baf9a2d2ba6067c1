//! Scattering toward one outgoing direction.

use super::lobe_probabilities::LobeProbabilities;
use super::{Bsdf, OutgoingFrame, Parts, Scattered, cosine_weighted};
use crate::{Split, sheen};
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_1_PI;

/// Number of directions that [`OutgoingBsdf::resample`] chooses from.
const RESAMPLING_CANDIDATES: usize = 4;

/// A [`Bsdf`] for one outgoing direction: what does not depend on the incident direction is computed once.
pub struct OutgoingBsdf<'b, 'a> {
    bsdf: &'b Bsdf<'a>,
    view: OutgoingFrame,
    probabilities: LobeProbabilities,
}

impl<'a> Bsdf<'a> {
    /// The BSDF for one outgoing direction (world, unit): what depends on it alone is computed once.
    pub fn toward(&self, outgoing: DVec3) -> OutgoingBsdf<'_, 'a> {
        let view = self.outgoing_frame(outgoing);
        let probabilities = self.lobe_probabilities(&view);
        OutgoingBsdf { bsdf: self, view, probabilities }
    }
}

impl OutgoingBsdf<'_, '_> {
    /// [`Bsdf::evaluate`] times the cosine of the incident direction, and [`Bsdf::density`], 1/sr; without mirrors.
    pub fn scatter(&self, incident: DVec3) -> (Split, f64) {
        let value = self.bsdf.value(&self.view, incident);
        if value.total() == DVec3::ZERO {
            return (value, 0.0);
        }
        let cosine = self.view.frame.local(incident).z.abs();
        (value * cosine, self.bsdf.density_of(&self.view, &self.probabilities, incident))
    }

    /// Samples an incident direction, as [`Bsdf::sample`] does.
    pub fn sample(&self, u: [f64; 3]) -> Option<Scattered> {
        self.bsdf.sample_lobes(&self.view, &self.probabilities, u)
    }

    /// Samples an incident direction nearly in proportion to the light scattered from there: one of
    /// four directions of [`Self::sample`] is chosen by its weight and gets the mean of their
    /// weights (resampled importance sampling; Talbot, Cline and Egbert 2005). Unbiased like `sample`, but products of
    /// the weights along a path that is caught between near surfaces stay small. `random` supplies uniform numbers.
    pub fn resample(&self, mut random: impl FnMut() -> f64) -> Option<Scattered> {
        if self.is_single_lobe() {
            return self.sample([random(), random(), random()]);
        }
        let mut chosen: Option<(Scattered, f64)> = None;
        let mut sum = 0.0;
        for _ in 0..RESAMPLING_CANDIDATES {
            let Some(candidate) = self.sample([random(), random(), random()]) else { continue };
            let weight = candidate.weight.total().element_sum();
            sum += weight;
            chosen = chosen.or(Some((candidate, weight)));
            if random() * sum < weight {
                chosen = Some((candidate, weight));
            }
        }
        let (scattered, weight) = chosen?;
        let mean = sum / RESAMPLING_CANDIDATES as f64;
        Some(Scattered { weight: scattered.weight * (mean / weight), ..scattered })
    }

    /// What crossing the surface (or not) does to radiance whose flux is conserved: 1/η² through an interface that refracts. It
    /// is part of the weights of sampled directions, not of the albedo; the factors of a path into glass and out again
    /// cancel.
    pub fn radiance_scale(&self, crosses: bool) -> f64 {
        let (bsdf, is_refracted) = (self.bsdf, self.bsdf.shares[2] > 0.0 && !self.bsdf.surface.is_thin);
        if crosses && is_refracted { bsdf.eta(&self.view).powi(-2) } else { 1.0 }
    }

    /// Whether one lobe alone is sampled.
    fn is_single_lobe(&self) -> bool {
        let LobeProbabilities { coat, gloss, glass, spread, through, returned } = self.probabilities;
        [coat, gloss, glass, spread, through, returned].into_iter().any(|probability| probability == 1.0)
    }

    /// The albedo in both parts: the share of uniform light from everywhere that is scattered.
    pub fn albedo(&self) -> Split {
        self.bsdf.albedo_toward(&self.view)
    }

    /// The albedo of the spread lobes ([`Parts`]), linear RGB: the share of light from all around that they send in
    /// the outgoing direction.
    pub fn spread_albedo(&self) -> DVec3 {
        let (bsdf, side) = (self.bsdf, &self.view.side);
        if self.view.o.z <= 0.0 {
            return DVec3::ZERO;
        }
        let [metal, dielectric, _] = bsdf.shares;
        let lost = bsdf.lost(side.shares);
        let multiple = (bsdf.multiple(0) * metal + bsdf.multiple(1) * dielectric) * lost;
        let share = dielectric * (1.0 - bsdf.surface.diffuse_transmission);
        let ground = side.beneath * bsdf.surface.base_color * share;
        let mut all = (multiple + ground) * (1.0 - side.sheen);
        if let Some(cloth) = bsdf.surface.sheen {
            all += cloth.color * sheen::albedo(self.view.o.z, cloth.roughness);
        }
        all * (1.0 - side.coat)
    }

    /// Value times cosine by parts, and the density, 1/sr, with which [`Self::sample_sharp`] generates `incident`.
    pub fn scatter_parts(&self, incident: DVec3) -> (Parts, f64) {
        let Parts { spread, sharp } = self.bsdf.parts(&self.view, incident);
        let cosine = self.view.frame.local(incident).z.abs();
        let has_sharp = sharp.total() != DVec3::ZERO;
        let density = if has_sharp { self.sharp_density(incident) } else { 0.0 };
        (Parts { spread: spread * cosine, sharp: sharp * cosine }, density)
    }

    fn sharp_density(&self, incident: DVec3) -> f64 {
        self.probabilities
            .without_spread()
            .map_or(0.0, |probabilities| self.bsdf.density_of(&self.view, &probabilities, incident))
    }

    /// Samples an incident direction of the spread lobes ([`Parts`]); returns it with its density, 1/sr. `None` where
    /// nothing is spread.
    pub fn sample_spread(&self, u: [f64; 2]) -> Option<(DVec3, f64)> {
        if self.probabilities.spread == 0.0 || self.view.o.z <= 0.0 {
            return None;
        }
        let i = cosine_weighted(DVec2::from_array(u));
        (i.z > 0.0).then(|| (self.view.frame.world(i), i.z * FRAC_1_PI))
    }

    /// The density, 1/sr, with which [`Self::sample_spread`] generates `incident`.
    pub fn spread_density(&self, incident: DVec3) -> f64 {
        if self.probabilities.spread == 0.0 {
            0.0
        } else {
            self.view.frame.local(incident).z.max(0.0) * FRAC_1_PI
        }
    }

    /// Samples an incident direction of the sharp lobes ([`Parts`]) from uniform numbers in [0, 1). `None` if there
    /// are none or nothing is scattered that way.
    pub fn sample_sharp(&self, u: [f64; 3]) -> Option<Scattered> {
        let probabilities = self.probabilities.without_spread()?;
        let scattered = self.bsdf.sample_lobes(&self.view, &probabilities, u)?;
        let Some(density) = scattered.density else { return Some(scattered) };
        let sharp = self.bsdf.parts(&self.view, scattered.incident).sharp;
        let weight = sharp * (self.view.frame.local(scattered.incident).z.abs() / density);
        (weight.total() != DVec3::ZERO).then_some(Scattered { weight, ..scattered })
    }

    /// Whether all lobes are spread ([`Parts`]).
    pub fn is_spread(&self) -> bool {
        self.probabilities.without_spread().is_none()
    }

    /// The shading normal (world, unit), on the outgoing side.
    pub fn normal(&self) -> DVec3 {
        self.view.frame.normal
    }

    /// [`Bsdf::coverage_shares`] for this outgoing direction.
    pub fn coverage_shares(&self) -> [f64; 2] {
        self.bsdf.shares_of(self.bsdf.albedo_toward(&self.view))
    }
}
