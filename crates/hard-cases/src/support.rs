//! Pictures, light fields and error measures that the cases share.

pub mod light_field;
pub mod measure;
pub mod shot;
