//! The paint view: the scene in 3D, in the false colours of its focus, painted on directly.
//!
//! ```text
//! scene, atlas ──▶ SurfaceMesh ────┐
//! focus map ────▶ FocusTexture ────┼─▶ SurfaceRenderer ──▶ texture ──▶ PaintView (panel, pointer, ring)
//! OrbitCamera, SurfaceAppearance ──┘
//! ```

mod changed_pixels;
mod device_errors;
mod focus_texture;
mod legend;
mod orbit_camera;
#[cfg(test)]
mod shader_twin;
mod surface_mesh;
mod surface_overlay;
mod surface_passes;
mod surface_renderer;
mod view;

pub use device_errors::GraphicsError;
pub use focus_texture::FocusTexture;
pub use orbit_camera::OrbitCamera;
pub use surface_mesh::SurfaceMesh;
pub use surface_renderer::{Stale, SurfaceFrame, SurfaceRenderer};
pub use view::{PIVOT_AT_INFINITY, PaintView, paint_hint};
