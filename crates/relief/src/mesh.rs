//! From cells to triangles.

pub(crate) mod cells;
pub(crate) mod corners;
pub(crate) mod triangulation;
