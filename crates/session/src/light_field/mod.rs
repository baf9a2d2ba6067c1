//! A document's light field: baked, kept on disk, summed, indexed, counted.
//!
//! Where its radiance comes from is chosen in `light.rs`, here and nowhere else. Everything above asks for a light field that
//! serves a camera, whoever made it.

mod aperture_image;
mod baking;
mod changes;
mod field_watch;
mod kept_light;
mod light;
mod light_errors;
mod light_file;
mod modelled;
mod photographed;
mod reach;
mod running_sum;
mod salf_file;
mod sample_index;
mod scene_work;
mod serves;
mod store;

pub use aperture_image::{ApertureCell, ApertureImage, BakedVisibility};
pub use baking::{bake, bake_unpacked};
pub use kept_light::LightQuality;
pub use light::can_refine_light;
pub use light_errors::LightErrors;
pub use modelled::{DENSE_SAMPLE_BYTES, Modelled, ModelledRow, TexelStatistics};
pub use salf_file::write_salf;
pub use store::LightFieldStore;

pub(crate) use baking::bake_with;
pub(crate) use changes::Changes;
pub(crate) use field_watch::{BakeState, FieldWatch};
pub(crate) use light::{ground_truth_light, is_photographed, quick_light, solve_light};
pub(crate) use photographed::{
    if_solved as solved_photograph_light, set_atlas as set_photograph_atlas, wait as photograph_light,
};
pub(crate) use reach::MarginReach;
pub(crate) use running_sum::{BakedField, FieldOptions, LightField, Plan, SumUpdate};
pub(crate) use serves::is_compatible;
pub(crate) use store::LIGHT_PASSES;
