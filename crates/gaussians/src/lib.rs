//! 3D Gaussian splats: files in every format, rays through them, and their wide-aperture pictures.
//!
//! ```text
//! file ─▶ GaussianCloud ─▶ GaussianView ─▶ Eye ─▶ hits, light of a ray ─▶ pictures
//!         (axes of the      (a camera's,      (one aperture
//!          file, packed)     sorted by depth)  point)
//! ```
//!
//! * [`open`], [`read`], [`read_gltf_attributes`]: PLY, compressed PLY, SPZ, SOG, splat, ksplat, glTF.
//! * [`GaussianCloud`], [`CloudBuilder`]: splats in memory; what cannot be drawn is left out and counted.
//! * [`merge_clouds`]: several clouds as one.
//! * [`have_neighbors`]: which points are not alone.
//! * [`CameraList`]: the views of `cameras.json`. [`Placement`]: where a cloud stands in the world.
//! * [`GaussianView`], [`Eye`], [`Hit`], [`RayLight`]: which splats a ray meets, and what it brings.
//! * [`CloudRay`]: where a ray of the world meets the surface of a cloud.
//! * [`render_truth`], [`render_pinhole`]: the ground truth, unpainted or with a focus for each splat.
//! * [`cluster_picture`], [`aperture_images`]: the splats of chief rays as samples of a light field.
//! * [`write_ply`], [`write_focus_table`], [`read_focus_table`]: scenes and focus out, focus in.
//!
//! The image formation is that of training, not of viewers: responses at each ray's greatest, in the order of the means' depth, the sum of a
//! ray decoded from sRGB. See [`view`](GaussianView) and [`RayLight`].
//!
//! # Example
//!
//! ```
//! use gaussians::{CloudBuilder, CloudTraits, Eye, GaussianView, Placement, Splat};
//! use glam::{DVec2, DVec3, Quat, Vec3};
//!
//! let mut builder = CloudBuilder::new(0, 1);
//! let ball = Splat {
//!     mean: Vec3::new(0.0, 0.0, -4.0),
//!     rotation: Quat::IDENTITY,
//!     log_scale: Vec3::splat(-2.0),
//!     opacity: 0.9,
//!     base_color: Vec3::ZERO,
//! };
//! builder.push(ball, &[]);
//! let cloud = builder.finish(CloudTraits::default());
//! let camera = lens::Camera::default();
//! let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
//! let hits = Eye::new(&view, DVec2::ZERO).hits(DVec3::Z);
//! assert!((hits[0].depth - 4.0).abs() < 1e-6 && (hits[0].weight - 0.9).abs() < 1e-6);
//! ```

pub mod cloud;
mod error;
mod files;
mod merged_cloud;
mod placement;
mod render;
mod samples;
mod view;

pub use cloud::{
    Axes, CloudBuilder, CloudTraits, ColorSpace, GaussianCloud, LeftOut, Reason, Splat, Toward,
    have_neighbors,
};
pub use error::GaussianError;
pub use files::{
    CameraList, CapturedView, GltfAttributes, ReadOptions, SplatFile, SplatFormat, may_be_splats, open, read,
    read_focus_table, read_gltf_attributes, write_focus_table, write_ply,
};
pub use merged_cloud::merge_clouds;
pub use placement::Placement;
pub use render::{
    Backdrop, EndLight, GaussianPicture, RayEnd, TruthOptions, render_pinhole, render_truth,
    render_truth_before,
};
pub use samples::{
    ApertureImages, ApertureScene, Cluster, ClusterOptions, Clusters, PicturePoint, aperture_images,
    cluster_picture,
};
pub use view::{CloudRay, Eye, GaussianView, Hit, LOW_PASS_PX2, RayLight, median_depth};
