//! Edges: spherical aberration as a weight over the aperture.

use crate::{Aperture, ApertureShape};
use glam::DVec2;

/// How bright the rims of discs are.
///
/// Light through the aperture point U weighs
///
/// ```text
/// W = 1 + b·σ(κ)·g(U)        σ = clamp(κ·R/(0.004·tanθ), −1, 1)
/// g = 2(|U|²/R₀² − m)/M      M = max(1, 2m, 2(max − m))
/// ```
///
/// m and max the mean and the largest |U|²/R₀² of the aperture: W is never negative, and 1 on average over an aperture that is not
/// cut. In focus it is 1; with b > 0 far discs have bright rims and near ones soft rims, with b < 0 the other way round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edges {
    /// b, in [−1, 1].
    pub strength: f64,
    /// m.
    pub mean: f64,
    /// M ≥ 1.
    pub extent: f64,
    /// 1/R₀², 1/length²; 0 for a pinhole.
    pub per_square: f64,
    /// σ for each κ while it is below 1: R/(0.004·tanθ), a length.
    pub per_kappa: f64,
}

/// σ is 1 from this radius of the circle of confusion on, half picture heights.
pub const FULL_EDGE: f64 = 0.004;

/// Rows that the aperture is cut into for its moments.
const ROWS: usize = 512;

impl Edges {
    /// The edges of strength `strength` of an aperture of radius R = `radius` whose lens is `widest_radius` R₀ wide (scene units).
    pub(super) fn new(
        strength: f64,
        aperture: &Aperture,
        radius: f64,
        widest_radius: f64,
        tan_half_yfov: f64,
    ) -> Self {
        let stop = if widest_radius > 0.0 { radius / widest_radius } else { 0.0 };
        let [mean, largest] =
            if strength == 0.0 { [0.5, 1.0] } else { squares(aperture) }.map(|square| square * stop * stop);
        Self {
            strength,
            mean,
            extent: (2.0 * mean).max(2.0 * (largest - mean)).max(1.0),
            per_square: if widest_radius > 0.0 { 1.0 / (widest_radius * widest_radius) } else { 0.0 },
            per_kappa: radius / (FULL_EDGE * tan_half_yfov),
        }
    }

    /// b·σ(κ), in [−1, 1], of a defocus κ (1/length).
    #[inline]
    pub fn steepness(&self, kappa: f64) -> f64 {
        self.strength * (kappa * self.per_kappa).clamp(-1.0, 1.0)
    }

    /// W, in [0, 2], of the aperture point `u` (scene units) for a defocus κ.
    #[inline]
    pub fn weight(&self, u: DVec2, kappa: f64) -> f64 {
        let g = 2.0 * (u.length_squared() * self.per_square - self.mean) / self.extent;
        1.0 + self.steepness(kappa) * g
    }
}

/// The mean and the largest |u|² of an aperture, u in units of its radius.
fn squares(aperture: &Aperture) -> [f64; 2] {
    let rows = aperture.rows(ROWS);
    let height = 2.0 / ROWS as f64;
    let (mut sum, mut area, mut largest) = (0.0, 0.0, 0.0f64);
    for (row, runs) in rows.rows.iter().enumerate() {
        let v = -1.0 + (row as f64 + 0.5) * height;
        for run in &runs.runs {
            let (width, middle) = (run.end - run.start, (run.start + run.end) / 2.0);
            let light = width * run.transmission;
            area += light;
            sum += light * (middle * middle + width * width / 12.0 + v * v + height * height / 12.0);
            let edge = run.start.abs().max(run.end.abs());
            largest = largest.max(edge * edge + (v.abs() + height / 2.0).powi(2));
        }
    }
    let most =
        if matches!(aperture.shape, ApertureShape::Disc | ApertureShape::Polygon { .. }) { 1.0 } else { 2.0 };
    [if area > 0.0 { sum / area } else { 0.5 }, largest.min(most)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ApertureMask, ApertureSampler};
    use std::sync::Arc;

    fn edges(aperture: &Aperture, strength: f64, stop: f64) -> Edges {
        Edges::new(strength, aperture, 0.02 * stop, 0.02, 0.3)
    }

    fn apertures() -> Vec<Aperture> {
        let ring = (0..64).map(|k| f32::from(k % 8 == 0 || k % 8 == 7 || !(8..56).contains(&k))).collect();
        let ring = ApertureMask { width: 8, height: 8, transmission: ring, file: String::new() };
        vec![
            ApertureShape::Disc.into(),
            ApertureShape::Polygon { blades: 5, rotation: 0.2, roundness: 0.3 }.into(),
            ApertureShape::Square.into(),
            Aperture { shape: ApertureShape::Disc, ratio: 2.0 },
            ApertureShape::Mask(Arc::new(ring)).into(),
        ]
    }

    #[test]
    fn an_uncut_aperture_keeps_its_energy() {
        const SIDE: usize = 400;
        for aperture in apertures() {
            let sampler = ApertureSampler::new(&aperture);
            for (strength, stop) in [(1.0, 1.0), (-1.0, 1.0), (0.7, 0.5)] {
                let edges = edges(&aperture, strength, stop);
                let at = |k: usize| (k as f64 + 0.5) / SIDE as f64;
                let weights = (0..SIDE * SIDE).map(|k| {
                    let u = sampler.sample(at(k % SIDE), at(k / SIDE)) * 0.02 * stop;
                    edges.weight(u, 9.0)
                });
                let weights: Vec<f64> = weights.collect();
                let mean = weights.iter().sum::<f64>() / weights.len() as f64;
                assert!((mean - 1.0).abs() < 1e-3, "{aperture:?} {strength}: {mean}");
                assert!(weights.iter().all(|weight| *weight > -1e-3), "{aperture:?} {strength}");
                // The control: weights that are not about their mean.
                let shifted = Edges { mean: edges.mean - 0.05, ..edges };
                assert!((shifted.weight(DVec2::ZERO, 9.0) - edges.weight(DVec2::ZERO, 9.0)).abs() > 0.02);
            }
        }
    }

    #[test]
    fn bright_rims_change_sides_with_the_focus() {
        let disc = ApertureShape::Disc.into();
        let (rim, middle) = (DVec2::new(0.02, 0.0), DVec2::ZERO);
        let edges = edges(&disc, 0.8, 1.0);
        let contrast = |kappa| edges.weight(rim, kappa) - edges.weight(middle, kappa);
        assert!(contrast(0.5) > 1.5 && contrast(-0.5) < -1.5, "{} {}", contrast(0.5), contrast(-0.5));
        assert_eq!((contrast(0.0), edges.weight(rim, 0.0)), (0.0, 1.0));
        // No jump through the focus.
        let small = 0.1 / edges.per_kappa;
        assert!((contrast(small) / contrast(0.5) - 0.1).abs() < 1e-9);
    }

    #[test]
    fn a_disc_has_the_moments_of_the_formula() {
        let edges = edges(&ApertureShape::Disc.into(), 1.0, 1.0);
        assert!((edges.mean - 0.5).abs() < 1e-4 && (edges.extent - 1.0).abs() < 2e-4, "{edges:?}");
        let stopped = Edges::new(1.0, &ApertureShape::Disc.into(), 0.01, 0.02, 0.3);
        assert!((stopped.mean - 0.125).abs() < 1e-4 && stopped.extent == 1.0, "R₀ stays: {stopped:?}");
    }
}
