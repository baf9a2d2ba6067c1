//! The character of a lens: what a real glass does beside focusing, and what its bokeh is known for.
//!
//! * [`Character`]: the numbers of a lens, as they are saved.
//! * [`Rim`]: an opening before or behind the aperture that cuts it for points beside the axis: *cat's eye*.
//! * [`CharacterOptics`]: the same, reduced to what is asked of a ray: whether it passes, its weight, its colours' places.
//! * [`Falloff`], [`Vignetting`]: how much less light arrives beside the axis.
//!
//! q₀ is a point's chief place from the optical axis, in half picture heights; R₀ the lens's widest radius, which stays when it is
//! stopped down.

mod character_optics;
mod edges;
mod falloff;
mod parameters;
mod rims;
mod vignetting;

pub use character_optics::{CHANNELS, CharacterOptics, GREEN};
pub use edges::{Edges, FULL_EDGE};
pub use falloff::Falloff;
pub use parameters::Character;
pub use rims::{Rim, RimLimit};
pub use vignetting::{Vignette, Vignetting};
