//! What is asked of a whole scene: its appearance at a point, its world, its photographs.

mod gloss_lookup;
mod memory;
mod scene_photographs;
mod scene_world;
mod surface_color;
