//! Other ways to make the picture, to compare the light field with.
//!
//! | method | knows | knob | fails at |
//! | --- | --- | --- | --- |
//! | [`gather`]: blur of the pinhole picture, by each pixel's own circle | one surface a pixel ([`FirstHits`]) | – | partial occlusion, edges, light from outside the frame |
//! | [`layered`]: the same, cut to layers by depth and composited | one surface a pixel | layers | the same, and seams between layers |
//! | [`shift_and_add`]: m × m pinhole views, refocused | rays through m² aperture points | views a side | defocus beyond the [ghosting bound](ghosting_bounds) |
//! | [`scatter`]: every ray of the SALF thrown at one pixel | all that the splat knows | rays a sample | noise, time |
//!
//! Each returns a [`lens::Picture`]: conserved radiance with its coverage, the same bits for any number of threads. Each
//! checks what it is given, reports progress and can be cancelled.

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
