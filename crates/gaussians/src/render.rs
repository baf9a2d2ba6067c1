//! Pictures of splats: through a pinhole, and through an aperture, by tracing rays.

mod aperture_points;
mod backdrop;
mod pixel_box;
mod truth;

pub use backdrop::{Backdrop, EndLight, RayEnd};
pub use truth::{GaussianPicture, TruthOptions, render_pinhole, render_truth, render_truth_before};
