//! The texture atlas: every triangle of the scene has a place of its own in one texture.

mod atlas;

pub use atlas::{Atlas, AtlasTexel, Chart};
