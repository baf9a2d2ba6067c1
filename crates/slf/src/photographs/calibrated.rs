//! What photographs show, as radiance: sightings with their exposures undone.

use super::constant::Sample;
use super::gains::Exposure;
use super::sightings::{Sighting, Sightings};
use super::texels::Texels;
use glam::DVec3;
use scene::View;

/// Sightings with their exposures undone.
pub(crate) struct Calibrated<'a> {
    pub texels: &'a Texels,
    pub sightings: &'a Sightings,
    pub views: &'a [View],
    pub exposures: &'a [Exposure],
}

/// What was at the sensor's limit says that it was at least so bright: it counts this much.
const CLIPPED_COUNTS: f32 = 0.05;

impl Calibrated<'_> {
    /// What photographs show of a texel, by view, into `samples`.
    pub fn samples_into(&self, texel: usize, samples: &mut Vec<Sample>) {
        let position = self.texels.position(texel);
        samples.clear();
        samples.extend(self.sightings.of_texel(texel).iter().map(|sighting| {
            let number = usize::from(sighting.view);
            let view = &self.views[number];
            // It was projected before, by the same lens.
            let pixel = view.project(position).unwrap_or_default();
            let light = self.sightings.light(sighting) * self.exposures[number].to_radiance(view, pixel);
            let counts = 1.0 - (1.0 - CLIPPED_COUNTS) * sighting.clipped();
            Sample { light, weight: sighting.weight() * counts }
        }));
    }

    /// Where the camera of a sighting stood.
    pub fn eye(&self, sighting: &Sighting) -> DVec3 {
        self.views[usize::from(sighting.view)].position()
    }
}
