//! A glTF scene, read safely and flattened to world-space triangles.
//!
//! * [`load`] reads a file; [`inspect`] says what is in one, even if it has no triangle.
//! * [`Scene`]: what everything else works on.
//! * [`SurfacePoint`]: an address on the surface: triangle and barycentrics. What the surface looks like there:
//!   [`Scene::base_color`], [`Scene::emitted`], [`Scene::opacity`], [`Scene::shading_normal`].
//! * [`SurfaceField`]: anything that has a value at every surface point (focus, radiance).
//! * [`MeshHealth`]: what is odd about the triangles.

mod error;
mod inspection;
mod load;
mod load_options;
mod mesh_health;
mod model;
mod surface_color;
mod surface_point;
mod texture_lookup;

pub use error::{Fault, SceneError};
pub use inspection::Inspection;
pub use load::{inspect, load};
pub use load_options::LoadOptions;
pub use mesh_health::MeshHealth;
pub use model::{
    AlphaMode, Image, ImageLevel, Light, LightKind, Material, Node, Part, Scene, SceneCamera, TextureRef,
    Triangle, Wrap,
};
pub use surface_point::{SurfaceField, SurfacePoint};
