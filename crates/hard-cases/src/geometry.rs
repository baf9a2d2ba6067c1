//! Cases of rays, triangles and texels.

pub mod rays;
pub mod texels;
pub mod triangles;
