//! Disparity of a light field's views, found from the pictures alone: no training, no files, only numbers.
//!
//! Views lie on a plane, at places of a grid: a full one, a cross, a row, a hexagon, three by three far apart. A point that the
//! reference shows at (x, y) is at (x − d Δcolumn, y − d Δrow) in a view (Δcolumn, Δrow) steps away; d is its *disparity*, larger
//! for what is nearer. [`find`] tells it for every pixel of the reference, and of other views as far as they are asked for, so
//! that background which the reference does not see is known, too.
//!
//! The road: `planes` (pictures as they are matched) → `vignetting` (outer views evened out) and `coarse` (a first look at small
//! pictures: the range) → `sweep` (what every disparity costs, by the best half of the views: `halves`) → `semi_global` (costs of
//! neighbours joined) → `choice` (a `label` a pixel; by strips: `matching`) → `refinement`: in rounds, what views that see a point
//! say of its place (`hiding`, `evidence`), and least squares with its neighbours (`lines`) → `strays` (specks) → `other_view` (moved there, and what
//! was hidden matched anew). Values are encoded as for display: there noise is even. The result does not depend on how many
//! threads there are.
//!
//! [`colour_coded`] is the other way to disparities: a map that a program wrote as colours, read back with the help of a few
//! disparities that are known.
//!
//! Not modelled: gloss that moves (views disagree: low confidence), glass, views that are turned or not evenly spaced otherwise than
//! by their positions.

mod asked;
mod checks;
mod choice;
mod coarse;
pub mod colour_coded;
mod error;
mod evidence;
mod find;
mod halves;
mod hiding;
mod labels;
mod lines;
mod map;
mod matching;
mod noise;
mod other_view;
mod planes;
mod refinement;
mod semi_global;
mod strays;
mod sweep;
mod view;
mod vignetting;

pub use asked::DisparityRequest;
pub use error::DisparityError;
pub use find::estimate_disparities;
pub use map::DisparityMap;
pub use view::{MIN_SIDE_PX, Picture, View};

/// Changes whenever what is found does: of maps that are kept.
pub const VERSION: u32 = 2;
