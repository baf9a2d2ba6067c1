//! The geometry of a file: nodes, accessors, primitives, instances and skins, and their assembly into a scene.

pub(crate) mod accessor;
pub(crate) mod assembly;
pub(crate) mod hierarchy;
pub(crate) mod instancing;
pub(crate) mod primitive;
pub(crate) mod skin;
pub(crate) mod splat_primitive;
pub(crate) mod tangents;
pub(crate) mod triangulation;
