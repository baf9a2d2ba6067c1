//! Preparation of a disparity map before it becomes a surface: holes, size, rounding, repair by hand.

pub(crate) mod filling;
pub(crate) mod repair;
pub(crate) mod roughness;
pub(crate) mod rounding;
pub(crate) mod upsampling;
