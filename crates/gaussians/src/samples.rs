//! Splats as samples of a light field: what a chief ray meets, in clusters, and which part of the aperture sees each.
//!
//! The splats on a pixel's chief ray, from near to far, are parted where their circles of confusion differ visibly. A *cluster* is a sample at its mean
//! inverse depth. Toward each cell of the aperture it has the *share* of the ray's light that its own members send: not that of a slab of depth, so that
//! each splat is counted once, and surfaces do not shade themselves.

mod aperture_images;
mod clusters;
mod eye_picture;

pub use aperture_images::{ApertureImages, ApertureScene, PicturePoint, aperture_images};
pub use clusters::{Cluster, ClusterOptions, Clusters, cluster_picture};
