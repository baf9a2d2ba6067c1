//! Light fields: baking them, storing them as files, and counting their samples.

mod baking;
mod camera_compatibility;
mod light_field_store;
mod modelled;
mod salf_file;

pub(crate) use baking::bake_with;
pub use baking::{bake, bake_unpacked};
pub use camera_compatibility::{is_baked_for, is_compatible};
pub use light_field_store::LightFieldStore;
pub use modelled::{DENSE_SAMPLE_BYTES, Modelled, ModelledRow, TexelStatistics};
pub use salf_file::write_salf;
