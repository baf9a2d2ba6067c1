//! Options for making light from photographs.

use scene::LoadOptions;

/// Options of [`PhotographLight::solve`](crate::PhotographLight::solve).
#[derive(Clone, Debug, PartialEq)]
pub struct PhotographOptions {
    /// Limits for reading each picture.
    pub load: LoadOptions,
    /// Which model is fitted to the photographs.
    pub model: PhotographModel,
    /// How far the given poses are trusted.
    pub poses: Poses,
    /// Memory limit of the work, bytes, not counting the scene, its hierarchy and the atlas. Photographs and texels are
    /// made coarser if they would not fit.
    pub max_memory: u64,
}

impl Default for PhotographOptions {
    /// The full model, aligned poses and 1.6 GiB of memory.
    fn default() -> Self {
        Self {
            load: LoadOptions::default(),
            model: PhotographModel::default(),
            poses: Poses::default(),
            max_memory: 1600 << 20,
        }
    }
}

/// The model that is fitted to the photographs of a texel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PhotographModel {
    /// All that the photographs contain: constant, mirrored and residual parts.
    #[default]
    Light,
    /// The colour of the one photograph with the finest resolution at each texel, the same toward all directions. This
    /// is what texturing tools make of a capture; it serves as a baseline.
    OneView,
}

/// How far the poses of photographs, and the surface, are trusted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Poses {
    /// Up to a few pixels: photographs are aligned with each other where that improves their agreement.
    #[default]
    Aligned,
    /// Exactly: photographs are used as calibrated. [`PhotographModel::OneView`] always does so.
    AsCalibrated,
}
