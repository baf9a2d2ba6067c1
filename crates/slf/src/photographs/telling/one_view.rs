//! The texture that one photograph a texel makes: what light from many is compared with.

use super::calibrated::CalibratedObservations;
use super::mirrored::Mirrored;
use super::residuals::Residuals;
use super::told::{RadianceModel, observed_shares};
use glam::Vec3;
use rayon::prelude::*;

/// The colours of the photographs that see each texel finest: most pixels over its area, as far as they see it at all.
pub(crate) fn fit_single_view(radiance: &CalibratedObservations<'_>) -> RadianceModel {
    let texels = radiance.texels;
    let constant = (0..texels.count())
        .into_par_iter()
        .map_init(Vec::new, |samples, texel| {
            radiance.collect_samples(texel, samples);
            let (position, normal) = (texels.position(texel), texels.normal(texel).as_dvec3());
            let fineness = |number: usize| {
                let observation = &radiance.observations.of_texel(texel)[number];
                let away = radiance.eye(observation) - position;
                samples[number].weight * (normal.dot(away).abs() / away.length().powi(3)) as f32
            };
            let finest = (0..samples.len()).max_by(|&a, &b| fineness(a).total_cmp(&fineness(b)));
            finest.map_or(Vec3::ZERO, |finest| samples[finest].light)
        })
        .collect();
    let (mirrored, residuals) = (Mirrored::none(texels.count()), Residuals::none(texels.count()));
    RadianceModel { constant, observed_share: observed_shares(radiance), mirrored, residuals }
}
