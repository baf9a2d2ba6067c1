//! What is told of each texel: parts that together are its light.

use super::calibrated::Calibrated;
use super::constant::robust_mean;
use super::mirrored::Mirrored;
use super::residuals::{Residuals, Ways};
use glam::Vec3;
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;

/// What is told of the texels that photographs see.
pub(crate) struct Told {
    pub constant: Vec<Vec3>,
    /// 1 photographed, 0 not.
    pub seen: Vec<f32>,
    pub mirrored: Mirrored,
    pub residuals: Residuals,
}

/// How far each texel was photographed, in [0, 1].
pub(crate) fn seen(radiance: &Calibrated<'_>) -> Vec<f32> {
    let evidence =
        |texel| radiance.sightings.of_texel(texel).iter().map(|sighting| sighting.weight()).sum::<f32>();
    (0..radiance.texels.count()).into_par_iter().map(|texel| (evidence(texel) / SEEN).min(1.0)).collect()
}

/// Evidence of a texel (weights of its samples, summed) from which on it counts as photographed.
pub(crate) const SEEN: f32 = 0.25;

/// The robust means of what photographs show of each texel.
fn means(radiance: &Calibrated<'_>, progress: &dyn Progress) -> Result<Vec<Vec3>, Cancelled> {
    let mean = |(samples, belonging): &mut (Vec<_>, Vec<_>), texel| {
        progress.check()?;
        radiance.samples_into(texel, samples);
        Ok(robust_mean(samples, belonging))
    };
    (0..radiance.texels.count()).into_par_iter().map_init(Default::default, mean).collect()
}

/// All that photographs carry.
pub(crate) fn told(radiance: &Calibrated<'_>, progress: &dyn Progress) -> Result<Told, Cancelled> {
    let texels = Stage::named(progress, "texels", 0.0, 0.15);
    let mut constant = means(radiance, &texels)?;
    let seen = seen(radiance);
    texels.report(1.0);
    let mirrors = Stage::named(progress, "mirrors", 0.15, 0.45);
    let (mirrored, beside_mirrored) = Mirrored::of(radiance, &constant, &mirrors)?;
    let ways = Ways { radiance, plain: &constant, beside_mirrored: &beside_mirrored, mirrored: &mirrored };
    let (share, residuals) = ways.residuals(&Stage::named(progress, "gloss", 0.45, 1.0))?;
    for ((constant, beside), share) in constant.iter_mut().zip(beside_mirrored).zip(&share) {
        *constant = constant.lerp(beside, *share);
    }
    let mirrored = mirrored.scaled(&share);
    Ok(Told { constant, seen, mirrored, residuals })
}
