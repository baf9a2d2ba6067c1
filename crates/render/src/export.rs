//! Exporting scenes as GLB, with their atlas and the lens of the shot camera.

mod scene_file;
mod shot_extras;

pub use scene_file::{export_glb, write_scene, write_unwrapped};
