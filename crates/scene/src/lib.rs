//! A glTF scene, read safely and flattened to world-space triangles.
//!
//! * [`Scene`]: what everything else works on.
//! * [`SurfacePoint`]: an address on the surface: triangle and barycentrics.
//! * [`SurfaceField`]: anything that has a value at every surface point (focus, radiance).

mod model;
mod surface_point;

pub use model::{
    AlphaMode, Image, ImageLevel, Light, LightKind, Material, Node, Part, Scene, SceneCamera, TextureRef, Triangle, Wrap,
};
pub use surface_point::{SurfaceField, SurfacePoint};
