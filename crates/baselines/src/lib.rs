//! Other methods that make the picture, as baselines for the light field.
//!
//! | method | input | parameter | fails at |
//! | --- | --- | --- | --- |
//! | [`gather_blur`]: blur of the pinhole picture, by each pixel's own circle | one surface per pixel ([`FirstHits`]) | – | partial occlusion, edges, light from outside the frame |
//! | [`layered_blur`]: the same, cut to layers by depth and composited | one surface per pixel | layers | the same, and seams between layers |
//! | [`shift_and_add`]: m × m pinhole views, refocused | rays through m² aperture points | views per side | defocus beyond the [ghosting bound](ghosting_bounds) |
//! | [`scatter_rays`]: every ray of the SALF added to one pixel | the light field, as the splat has it | rays per sample | noise, time |
//!
//! Each returns a [`lens::Picture`]: conserved radiance with its coverage, the same bits for any number of threads. Each
//! validates its arguments, reports progress and can be cancelled.
//!
//! ```
//! // A point at 2 m, pixels of 5 µm, views 1 mm apart, a sensor at 50 mm: refocused planes within these offsets do not ghost.
//! let [nearest, farthest] = baselines::ghosting_bounds(2.0, 5e-6, 1e-3, 0.05);
//! assert!(nearest < 0.0 && farthest > 0.0);
//! ```

mod aperture_blur;
mod aperture_grid;
mod bands;
mod error;
#[cfg(test)]
mod facts;
mod first_hits;
mod gather;
mod ghosting;
mod layered;
mod scatter;
#[cfg(test)]
mod test_light;
mod views;

pub use error::BaselineError;
pub use first_hits::FirstHits;
pub use gather::gather_blur;
pub use ghosting::{beyond_ghosting_bound, copies_apart_px, ghost_free_depths, ghosting_bounds};
pub use layered::{LayeredOptions, layered_blur};
pub use scatter::{ScatterOptions, scatter_rays};
pub use views::{ViewsOptions, shift_and_add};
