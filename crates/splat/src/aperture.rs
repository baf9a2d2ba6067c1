//! The lens's aperture: the rows of its shape, its images in all sizes, and what of it partly occluded nodes see.

pub mod moments;
pub mod shape;
pub mod stencil;
