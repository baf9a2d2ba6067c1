//! Writing GLB files: a scene's file with its atlas as an additional UV set, and surfaces that have no file.

mod export_glb;
mod glb_document;
mod placed_meshes;
mod placed_primitive;
mod split_vertices;
mod surface_glb;
mod uv_set;
mod vertex_attributes;

pub use export_glb::{glb_bytes, write_amended_glb, write_glb};
pub use surface_glb::write_surface_glb;
