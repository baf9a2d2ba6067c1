//! Procedural scenes and pseudo-random numbers for tests and the hard cases.
//!
//! ```
//! use glam::DVec3;
//! use test_scenes::{Mesh, Random, scene_of, white};
//!
//! let mut random = Random(1);
//! let scene = scene_of([(Mesh::sphere(random.in_cube(), 1.0, 8), white()), (Mesh::wall(5.0, 9.0), white())]);
//! assert_eq!(scene.parts.len(), 2);
//! ```

mod random;
mod scenery;

pub use random::{Random, spread};
pub use scenery::{Mesh, one_sided, scene_of, unlit, unlit_scene_of, white};
