//! Cases of the thin lens: circles of confusion, focus offsets, the aperture plane, aperture masks.

pub mod aperture_plane;
pub mod character;
pub mod defocus;
pub mod masks;
pub mod offsets;
pub mod sampling;
pub mod scaling;
