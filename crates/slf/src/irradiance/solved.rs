//! Irradiance of patches that were solved together, bounce by bounce.

use super::patches::Patches;
use super::place::Place;
use glam::Vec3;

/// Solved irradiance: from this, the scene, the world and the solver's options all other light is gathered again.
#[derive(Clone, Debug, PartialEq)]
pub struct IrradianceSolution {
    /// Irradiance/π by patch (linear RGB radiance units), from sampled lights.
    pub direct: Vec<Vec3>,
    /// Irradiance/π by patch, all other light.
    pub indirect: Vec<Vec3>,
    /// Whether light was cut off after [`MAX_BOUNCES`](crate::MAX_BOUNCES) before it had died away.
    pub is_cut_off: bool,
}

/// Patches with their solution.
#[derive(Debug)]
pub(crate) struct SolvedPatches {
    pub patches: Patches,
    pub solution: IrradianceSolution,
}

impl SolvedPatches {
    /// The memory that they take, in bytes.
    pub fn bytes(&self) -> usize {
        self.patches.bytes() + size_of_val(&*self.solution.direct) + size_of_val(&*self.solution.indirect)
    }

    /// Whether they resolve the light of a surface that is seen through a lobe, by a ray of this length (scene units) whose direction
    /// had this density, 1/sr: the lobe covers half a patch there, and the part has patches enough.
    pub fn resolve(&self, part: u32, length: f64, density: f64) -> bool {
        /// Patches that a part has at least, to be told apart from another by more than its mean.
        const MIN_PATCHES_OF_PART: f64 = 32.0;
        let half_patch = 0.5 * self.patches.spacing(part);
        self.patches.estimated_count(part) >= MIN_PATCHES_OF_PART
            && length * length >= density * half_patch * half_patch
    }

    /// Indirect irradiance/π at a place; `None` if no patch covers it.
    pub fn indirect(&self, place: &Place) -> Option<Vec3> {
        self.patches.interpolate(place, |patch| self.solution.indirect[patch])
    }

    /// Direct and indirect irradiance/π at a place; `None` if no patch covers it.
    pub fn total(&self, place: &Place) -> Option<Vec3> {
        self.patches.interpolate(place, |patch| self.solution.direct[patch] + self.solution.indirect[patch])
    }
}
