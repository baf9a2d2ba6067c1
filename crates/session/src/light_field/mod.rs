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

pub use aperture_image::{ApertureCell, ApertureImage, KeptVisibility};
pub use baking::{bake, bake_unpacked};
pub use kept_light::LightQuality;
pub use light::may_be_refined;
pub use light_errors::LightErrors;
pub use modelled::{DENSE_SAMPLE_BYTES, Modelled, ModelledRow, TexelStatistics};
pub use salf_file::write_salf;
pub use store::LightFieldStore;

pub(crate) use baking::bake_with;
pub(crate) use changes::Changes;
pub(crate) use field_watch::{FieldWatch, Standing};
pub(crate) use light::{first_light, is_photographed, light, light_for_many_points};
pub(crate) use photographed::{
    if_known as photograph_light_if_known, keep_at as keep_photographs_at, wait as photograph_light,
};
pub(crate) use reach::Reach;
pub(crate) use running_sum::{BakedField, Brought, FieldOptions, LightField, Plan};
pub(crate) use serves::serves;
pub(crate) use store::LIGHT_PASSES;
