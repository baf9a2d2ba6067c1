//! The radiance model of all texels: the parts that add up to their light.

use super::calibrated::CalibratedObservations;
use super::mirrored::Mirrored;
use super::residuals::{CandidateModels, Residuals};
use super::robust_averaging::robust_mean;
use glam::Vec3;
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;

/// The fitted model of the texels that photographs observe.
pub(crate) struct RadianceModel {
    pub constant: Vec<Vec3>,
    /// 1 observed, 0 not.
    pub observed_share: Vec<f32>,
    pub mirrored: Mirrored,
    pub residuals: Residuals,
}

/// How far each texel was observed, in [0, 1].
pub(crate) fn observed_shares(calibrated: &CalibratedObservations<'_>) -> Vec<f32> {
    let evidence = |texel| {
        calibrated.observations.of_texel(texel).iter().map(|observation| observation.weight()).sum::<f32>()
    };
    (0..calibrated.texels.count())
        .into_par_iter()
        .map(|texel| (evidence(texel) / FULL_EVIDENCE).min(1.0))
        .collect()
}

/// Evidence of a texel (sum of its samples' weights) from which on it counts as fully observed.
pub(crate) const FULL_EVIDENCE: f32 = 0.25;

/// Robust means of what photographs show of each texel.
fn constant_parts(
    calibrated: &CalibratedObservations<'_>,
    progress: &dyn Progress,
) -> Result<Vec<Vec3>, Cancelled> {
    let mean = |(samples, inlier_weights): &mut (Vec<_>, Vec<_>), texel| {
        progress.check()?;
        calibrated.collect_samples(texel, samples);
        Ok(robust_mean(samples, inlier_weights))
    };
    (0..calibrated.texels.count()).into_par_iter().map_init(Default::default, mean).collect()
}

/// Fits the full model.
///
/// # Errors
/// [`Cancelled`] if `progress` asks to stop.
pub(crate) fn fit_radiance_model(
    calibrated: &CalibratedObservations<'_>,
    progress: &dyn Progress,
) -> Result<RadianceModel, Cancelled> {
    let texels = Stage::named(progress, "texels", 0.0, 0.15);
    let mut constant = constant_parts(calibrated, &texels)?;
    let observed_share = observed_shares(calibrated);
    texels.report(1.0);
    let mirrors = Stage::named(progress, "mirrors", 0.15, 0.45);
    let (mirrored, beside_mirrored) = Mirrored::fit(calibrated, &constant, &mirrors)?;
    let candidates = CandidateModels {
        calibrated,
        plain: &constant,
        beside_mirrored: &beside_mirrored,
        mirrored: &mirrored,
    };
    let (share, residuals) = candidates.fit_residuals(&Stage::named(progress, "gloss", 0.45, 1.0))?;
    for ((constant, beside_value), share) in constant.iter_mut().zip(beside_mirrored).zip(&share) {
        *constant = constant.lerp(beside_value, *share);
    }
    let mirrored = mirrored.scaled(&share);
    Ok(RadianceModel { constant, observed_share, mirrored, residuals })
}
