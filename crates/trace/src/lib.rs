//! Rays: first hit, occlusion, and the ray-traced ground truth.
//!
//! [`Tracer`] answers what a ray meets. Its way: a ray enters the f32 space of the boxes (`local_space`),
//! walks the tree (`hierarchy`), meets triangles in f64 (`watertight`) whose points may be cut away
//! (`presence`). What a point sees of a whole [`Square`] takes one
//! walk (`sight`), and so does what the rays of a [`Beam`] meet. [`truth`] sums such rays to the picture that everything
//! else is measured against.

mod beam;
mod hierarchy;
mod local_space;
mod radiance;
mod random;
mod ray;
mod tracer;
mod transparency;
pub mod truth;
mod visibility;
mod watertight;

pub use beam::Beam;
pub use radiance::{IncidentLight, OutgoingRadiance, Radiance, SampleSlot, ShadingPoint};
pub use ray::{Hit, Ray};
pub use tracer::Tracer;
pub use visibility::{PointSet, Square, SquareVisibility, TargetPoints, Viewpoint};
