//! What photographs show, as radiance: sightings with their exposures undone.

use super::constant::Sample;
use crate::photographs::places::Texels;
use crate::photographs::seeing::{Sighting, Sightings};
use glam::DVec3;

/// Sightings with their exposures undone.
pub(crate) struct Calibrated<'a> {
    pub texels: &'a Texels,
    /// Their exposures undone.
    pub sightings: &'a Sightings,
    /// Where the cameras stood, by view.
    pub eyes: &'a [DVec3],
}

impl Calibrated<'_> {
    /// What photographs show of a texel, by view, into `samples`.
    pub fn samples_into(&self, texel: usize, samples: &mut Vec<Sample>) {
        samples.clear();
        samples.extend(self.sightings.of_texel(texel).iter().map(|sighting| {
            let (light, weight) = (self.sightings.light(sighting), sighting.weight());
            Sample { light, weight, clipped: sighting.clipped() }
        }));
    }

    /// Where the camera of a sighting stood.
    pub fn eye(&self, sighting: &Sighting) -> DVec3 {
        self.eyes[usize::from(sighting.view)]
    }
}
