//! What photographs show, as radiance: sightings with their exposures undone.

use super::constant::Sample;
use crate::photographs::places::Texels;
use crate::photographs::seeing::{Observation, Observations};
use glam::DVec3;

/// Sightings with their exposures undone.
pub(crate) struct CalibratedObservations<'a> {
    pub texels: &'a Texels,
    /// Their exposures undone.
    pub observations: &'a Observations,
    /// Where the cameras stood, by view.
    pub eyes: &'a [DVec3],
}

impl CalibratedObservations<'_> {
    /// What photographs show of a texel, by view, into `samples`.
    pub fn collect_samples(&self, texel: usize, samples: &mut Vec<Sample>) {
        samples.clear();
        samples.extend(self.observations.of_texel(texel).iter().map(|observation| {
            let (light, weight) = (self.observations.light(observation), observation.weight());
            Sample { light, weight, clipped: observation.clipped() }
        }));
    }

    /// Where the camera of a sighting stood.
    pub fn eye(&self, observation: &Observation) -> DVec3 {
        self.eyes[usize::from(observation.view)]
    }
}
