//! The texture atlas: every triangle of the scene has a place of its own in one texture.
//!
//! The steps of [`Atlas::unwrap`], one file each:
//!
//! ```text
//! scene ─▶ part_mesh ─▶ reusable_charts (an artist's UVs, if they are sound)
//!             │      ─▶ patches ─▶ child (xatlas and uvunwrap) ─▶ planar (where the engines fail)
//!             ▼
//!          unpacked charts, each flat and free of overlap ─▶ packing ─▶ Atlas
//! ```
//!
//! Gaussian splats need no unwrapping: each has a texel (`splat_places`).
//!
//! From there, both ways: [`Atlas::position_of`] (surface → texel) and [`TexelMap`] (texel → surface, with exact
//! covered areas and the gutter's sources). [`child::run_if_child`] must be the first line of every program
//! that passes its own path as [`UnwrapOptions::child`].
//!
//! # Example
//!
//! ```
//! use atlas::{Atlas, UnwrapOptions};
//! use glam::DVec3;
//! use scene::{LoadOptions, Scene, SurfaceMesh};
//!
//! let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
//! let mesh = SurfaceMesh { positions, triangles: vec![[0, 1, 2]], ..SurfaceMesh::default() };
//! let scene = Scene::from_mesh(mesh, &LoadOptions::default()).unwrap();
//! let atlas = Atlas::unwrap(&scene, &UnwrapOptions::default(), &progress::Unwatched).unwrap();
//! let area: f64 = atlas.texels(&scene).iter().map(|texel| texel.area).sum();
//! assert!((area - 0.5).abs() < 1e-6); // the texels cover exactly the triangle
//! ```

mod atlas;
mod bytes;
mod error;
mod floor_place;
mod glb;
mod options;
mod packing;
mod splat_places;
mod texels;
mod unwrap;

pub use atlas::{Atlas, Chart};
pub use error::AtlasError;
pub use glb::{glb_bytes, write_amended_glb, write_glb, write_surface_glb};
pub use options::{Density, MAX_SIDE, MIN_GUTTER, UnwrapOptions, UvPolicy};
pub use texels::{AtlasTexel, DILATION_RADIUS, Dilation, NO_TEXEL, TexelMap};
pub use unwrap::child;
