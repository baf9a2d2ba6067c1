//! Ray tracing: first hits, occlusion, and the ray-traced ground truth.
//!
//! [`Tracer`] finds what a ray hits: the ray is transformed to the f32 space of the bounding boxes (`local_space`), traverses the
//! tree (`hierarchy`) and is intersected with triangles in f64 (`watertight`), whose points may be transparent
//! (`transparency`). The visibility of a whole [`Square`] from a point, or from many ([`SquareOccluders`]), takes a single traversal
//! (`visibility`), as do the rays of a [`Beam`]. [`truth`] integrates such rays to the reference picture, from the light that a [`Radiance`] provides.
//!
//! ```
//! use glam::DVec3;
//! use trace::Ray;
//!
//! let camera = lens::Camera::default();
//! let center = glam::DVec2::new(f64::from(camera.width), f64::from(camera.height)) / 2.0;
//! let ray = Ray::pinhole(&camera, glam::DVec2::ZERO, center);
//! assert!(ray.direction.normalize().distance(camera.world_direction(DVec3::Z)) < 1e-9);
//! ```

mod beam;
mod hierarchy;
mod local_space;
mod radiance;
mod random;
mod ray;
mod sight_device;
mod tracer;
mod transparency;
pub mod truth;
mod visibility;
mod watertight;

pub use beam::Beam;
pub use radiance::{IncidentLight, OutgoingRadiance, Radiance, SampleSlot, ShadingPoint};
pub use ray::{Hit, Ray};
pub use sight_device::{PreparedSight, SightDevice, SightQuery};
pub use tracer::{FlatHierarchy, FlatNode, FlatSpace, FlatTriangle, SplitPosition, SquareOccluders, Tracer};
pub use visibility::{PointSet, Square, SquareVisibility, TargetPoints, Viewpoint};
