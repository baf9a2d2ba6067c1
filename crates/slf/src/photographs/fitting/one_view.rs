//! Baseline: the texture made from a single photograph per texel.

use super::calibrated::CalibratedObservations;
use super::mirrored::Mirrored;
use super::radiance_model::{RadianceModel, observed_shares};
use super::residuals::Residuals;
use glam::Vec3;
use rayon::prelude::*;

/// Takes the colour of the photograph with the finest resolution at each texel: the most pixels over its area, weighted
/// by visibility.
pub(crate) fn fit_single_view(calibrated: &CalibratedObservations<'_>) -> RadianceModel {
    let texels = calibrated.texels;
    let constant = (0..texels.count())
        .into_par_iter()
        .map_init(Vec::new, |samples, texel| {
            calibrated.collect_samples(texel, samples);
            let (position, normal) = (texels.position(texel), texels.normal(texel).as_dvec3());
            let fineness = |index: usize| {
                let observation = &calibrated.observations.of_texel(texel)[index];
                let away = calibrated.eye(observation) - position;
                samples[index].weight * (normal.dot(away).abs() / away.length().powi(3)) as f32
            };
            let finest = (0..samples.len()).max_by(|&a, &b| fineness(a).total_cmp(&fineness(b)));
            finest.map_or(Vec3::ZERO, |finest| samples[finest].light)
        })
        .collect();
    let (mirrored, residuals) = (Mirrored::none(texels.count()), Residuals::none(texels.count()));
    RadianceModel { constant, observed_share: observed_shares(calibrated), mirrored, residuals }
}
