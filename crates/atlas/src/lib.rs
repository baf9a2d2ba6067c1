//! The texture atlas: every triangle of the scene has a place of its own in one texture.
//!
//! The road of [`Atlas::unwrap`], a file a step:
//!
//! ```text
//! scene ─▶ part_mesh ─▶ islands (an artist's UVs, if they are sound)
//!             │      ─▶ patches ─▶ child (xatlas, then uvunwrap) ─▶ planar (what no engine could do)
//!             ▼
//!          loose charts, each flat and free of overlap ─▶ pack ─▶ Atlas
//! ```
//!
//! From there both ways: [`Atlas::position_of`] (surface → texel) and [`TexelMap`] (texel → surface, with exact
//! covered areas and the gutter's sources). [`child::run_if_asked`] must be the first line of every program
//! that hands its own path to [`UnwrapOptions::child`].

mod atlas;
mod bytes;
mod chart;
mod chart_box;
pub mod child;
mod clip;
mod coverage;
mod dilation;
mod engine;
mod error;
mod export_glb;
mod flattening;
mod glb_document;
mod islands;
mod options;
mod overlap;
mod pack;
mod part_mesh;
mod patches;
mod placed_meshes;
mod placed_primitive;
mod planar;
mod shape;
mod skyline;
mod split_vertices;
mod surface_glb;
mod texel_map;
mod unwrap;
mod uv_set;
mod vertex_attributes;
mod xatlas;

pub use atlas::{Atlas, Chart};
pub use coverage::AtlasTexel;
pub use dilation::{DILATION_RADIUS, Dilation};
pub use error::AtlasError;
pub use export_glb::{glb_bytes, write_amended_glb, write_glb};
pub use options::{Density, MAX_SIDE, MIN_GUTTER, UnwrapOptions, UvPolicy};
pub use surface_glb::write_surface_glb;
pub use texel_map::{NO_TEXEL, TexelMap};
