//! Reading glTF files: from the bytes of a file to a scene.

pub(crate) mod animation;
pub(crate) mod budget;
pub(crate) mod compressed;
pub(crate) mod container;
pub(crate) mod document;
pub(crate) mod extension;
pub(crate) mod focus_brush_extras;
pub(crate) mod geometry;
pub(crate) mod image_based_light;
pub(crate) mod inspection;
pub(crate) mod lint;
pub(crate) mod load;
pub(crate) mod materials;
pub(crate) mod punctual_light;
pub(crate) mod repair;
pub(crate) mod resource;
pub(crate) mod scene_cameras;
pub(crate) mod schema;
pub(crate) mod source;
pub(crate) mod splats;

pub use animation::pose::{PosedScene, RestTriangle};
pub use animation::{Animation, AnimationTime};
pub use focus_brush_extras::{EXTRAS_KEY, EXTRAS_VERSION};
pub use inspection::Inspection;
pub use load::{AnimatedScene, inspect, load, with_source};
pub use source::{GltfSource, PartSource, StoredElements};
