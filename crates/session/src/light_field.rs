//! The light field of an open document: its running sum, and what it contains at a surface point.

mod aperture_fit;
mod aperture_image;
mod changes;
mod draft;
mod field_watch;
mod margin_reach;
mod relighting;
mod running_sum;
mod sample_index;

pub(crate) use aperture_fit::{ApertureFit, spare_camera};
pub use aperture_image::{ApertureCell, ApertureImage, BakedVisibility};
pub(crate) use changes::Changes;
pub(crate) use field_watch::{BakeState, FieldWatch};
pub(crate) use margin_reach::exceeds_margin;
pub(crate) use relighting::Relightable;
pub(crate) use running_sum::{BakedField, FieldOptions, LightField, Plan, SumUpdate};
