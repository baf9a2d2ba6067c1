//! Disparity of a light field's views, computed from the pictures alone: no training, no files, only numbers.
//!
//! Views lie on a plane, at positions of a grid: a full grid, a cross, a row, a hexagon, three by three far apart. A point that the
//! reference shows at (x, y) is at (x − d Δcolumn, y − d Δrow) in a view (Δcolumn, Δrow) steps away; d is its *disparity*, larger for
//! nearer points. [`estimate_disparities`] computes it for every pixel of the reference, and of other views on request, so that background
//! which is hidden from the reference gets disparities, too.
//!
//! The stages: `planes` (pictures as they are matched) → `vignetting` (outer views brightened) and `matching::coarse` (small pictures: the
//! range) → `matching` (the cost of every disparity by plane sweep, over the best half of the views; costs of neighbours aggregated; a
//! label per pixel) → `refinement` (in rounds, evidence of the views in which a point is visible, and least squares with its
//! neighbours) → `specks` (isolated outliers) → `other_view` (maps warped to other views, and what was hidden matched anew). Values are
//! encoded as for display: there noise is uniform. The result does not depend on the number of threads.
//!
//! [`colour_coded`] is another source of disparities: it decodes a map that a program wrote as colours, with the help of a few known
//! disparities.
//!
//! Not modelled: gloss that moves (views disagree: low confidence), glass, views that are rotated or unevenly spaced other than by their
//! positions.
//!
//! ```
//! use disparity::{DisparityRequest, Picture, View, estimate_disparities};
//! use progress::Unwatched;
//!
//! // A textured wall that moves by two pixels from view to view.
//! let wall = |step: usize| -> Vec<[f32; 3]> {
//!     let wave = |x: f32, y: f32| 0.5 + 0.2 * (0.9 * x + y).sin() + 0.2 * (0.4 * x - 0.7 * y).cos();
//!     (0..48 * 48).map(|i| [wave((i % 48 + 2 * step) as f32, (i / 48) as f32); 3]).collect()
//! };
//! let pictures = [wall(0), wall(1), wall(2)];
//! let views: Vec<View> = (0..3)
//!     .map(|k| View {
//!         picture: Picture { width: 48, height: 48, rgb: &pictures[k] },
//!         position: [k as f64, 0.0],
//!     })
//!     .collect();
//! let request = DisparityRequest { reference: 1, range: Some((0.0, 4.0)), ..DisparityRequest::default() };
//! let map = &estimate_disparities(&views, &request, &Unwatched).unwrap()[0];
//! assert!((map.disparity[24 * 48 + 24] - 2.0).abs() < 0.2);
//! ```

pub mod colour_coded;
mod error;
mod estimation;
mod map;
mod matching;
mod noise;
mod other_view;
mod planes;
mod refinement;
mod request;
mod specks;
mod validation;
mod view;
mod vignetting;

pub use error::DisparityError;
pub use estimation::estimate_disparities;
pub use map::DisparityMap;
pub use request::DisparityRequest;
pub use view::{MIN_SIDE_PX, Picture, View};

/// The version of the results: changes whenever they do, so that cached maps are recomputed.
pub const VERSION: u32 = 2;
