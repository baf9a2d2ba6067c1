//! How light is made from photographs.

use scene::LoadOptions;

/// How light is made from photographs.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotographOptions {
    /// Limits for each picture.
    pub load: LoadOptions,
    /// What is told of a texel.
    pub model: PhotographModel,
    /// How far poses are believed.
    pub poses: Poses,
    /// Bytes that the work may hold at once, the scene, its hierarchy and the atlas not counted. Photographs and texels are made coarser
    /// where they would not fit.
    pub max_memory: u64,
}

impl Default for PhotographOptions {
    /// 1.6 GiB.
    fn default() -> Self {
        Self {
            load: LoadOptions::default(),
            model: PhotographModel::default(),
            poses: Poses::default(),
            max_memory: 1600 << 20,
        }
    }
}

/// What light from photographs tells of a texel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PhotographModel {
    /// All that the photographs carry.
    #[default]
    Light,
    /// The colour of the one photograph that sees it finest, toward all directions alike: what texturing tools make of a capture, to
    /// compare with.
    OneView,
}

/// How far the poses of photographs, and the surface, are believed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Poses {
    /// To a few pixels: photographs are aligned with each other where that has them agree better.
    #[default]
    Aligned,
    /// As they are given. What texturing tools are compared by, [`PhotographModel::OneView`], always believes that.
    AsCalibrated,
}
