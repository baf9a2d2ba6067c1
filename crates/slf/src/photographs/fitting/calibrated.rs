//! Calibrated observations: what photographs show, as radiance.

use super::robust_averaging::Sample;
use crate::photographs::observations::{Observation, Observations};
use crate::photographs::texels::Texels;
use glam::DVec3;

/// Observations whose exposures are undone.
pub(crate) struct CalibratedObservations<'a> {
    pub texels: &'a Texels,
    /// Observations as radiance.
    pub observations: &'a Observations,
    /// Camera positions, by view.
    pub eyes: &'a [DVec3],
}

impl CalibratedObservations<'_> {
    /// Replaces `samples` by what photographs show of a texel, in the order of the views.
    pub fn collect_samples(&self, texel: usize, samples: &mut Vec<Sample>) {
        samples.clear();
        samples.extend(self.observations.of_texel(texel).iter().map(|observation| {
            let (light, weight) = (self.observations.light(observation), observation.weight());
            Sample { light, weight, clipped: observation.clipped() }
        }));
    }

    /// Camera position of an observation, in the world.
    pub fn eye(&self, observation: &Observation) -> DVec3 {
        self.eyes[usize::from(observation.view)]
    }
}
