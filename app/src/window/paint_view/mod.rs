//! The paint view: the scene in 3D, in the false colours of its focus, painted on directly.

mod focus_texture;
mod graphics;
mod orbit_camera;
mod surface_mesh;
mod surface_renderer;

pub use focus_texture::FocusTexture;
pub use graphics::GraphicsError;
pub use orbit_camera::OrbitCamera;
pub use surface_mesh::SurfaceMesh;
pub use surface_renderer::{SurfaceLook, SurfaceRenderer};
