//! The texture that one photograph a texel makes: what light from many is compared with.

use super::calibrated::Calibrated;
use super::mirrored::Mirrored;
use super::residuals::Residuals;
use super::told::{Told, seen};
use glam::Vec3;
use rayon::prelude::*;

/// The colours of the photographs that see each texel finest: most pixels over its area, as far as they see it at all.
pub(crate) fn one_view(radiance: &Calibrated<'_>) -> Told {
    let texels = radiance.texels;
    let constant = (0..texels.count())
        .into_par_iter()
        .map_init(Vec::new, |samples, texel| {
            radiance.samples_into(texel, samples);
            let (position, normal) = (texels.position(texel), texels.normal(texel).as_dvec3());
            let fineness = |number: usize| {
                let sighting = &radiance.sightings.of_texel(texel)[number];
                let away = radiance.eye(sighting) - position;
                samples[number].weight * (normal.dot(away).abs() / away.length().powi(3)) as f32
            };
            let finest = (0..samples.len()).max_by(|&a, &b| fineness(a).total_cmp(&fineness(b)));
            finest.map_or(Vec3::ZERO, |finest| samples[finest].light)
        })
        .collect();
    let (mirrored, residuals) = (Mirrored::none(texels.count()), Residuals::none(texels.count()));
    Told { constant, seen: seen(radiance), mirrored, residuals }
}
