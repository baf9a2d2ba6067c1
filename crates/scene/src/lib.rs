//! A glTF scene, read safely and flattened to world-space triangles.
//!
//! * [`load`] reads a file; [`inspect`] says what is in one, even if it has no triangle;
//!   [`with_source`] gives it as it is, to be written again.
//! * [`MovingScene`]: the scene of a file with animations, at any [`Moment`] of them.
//! * [`Scene`]: what everything else works on; [`Scene::of_mesh`] makes one of a [`SurfaceMesh`] that comes from elsewhere.
//! * [`SurfacePoint`]: an address on the surface: triangle and barycentrics. What the surface looks like there:
//!   [`Scene::base_color`], [`Scene::emitted`], [`Scene::opacity`], [`Scene::shading_normal`], [`Scene::bumped_normal`].
//! * [`Material`]: what a surface is made of. [`World`]: what lies beyond all surfaces.
//! * [`SurfaceField`]: anything that has a value at every surface point (focus, radiance).
//! * [`MeshHealth`]: what is odd about the triangles.
//! * [`View`]: a photograph of a place with the camera that took it; its pixels are read when they are needed.
//!
//! Files come from anywhere, so the reader trusts none: every index and byte range is checked before it is used,
//! memory, triangles and time are accounted for before they are taken, and only files inside the scene's
//! folder are opened. The document is read through the `gltf` crate, which gets a mended copy of the JSON: integers
//! written as floats are legal, and a flaw in something the picture does not need must not keep the rest from opening.
//!
//! The road of a file: `container` (GLB chunks), `json_text` → `mending` (typed by the `gltf` crate) → `document` → `hierarchy` (which nodes, where) →
//! `primitive` (checked `accessor`s to triangles, morphed) → `assembly` (instances and skins into the world) →
//! `variants`, `material_textures`, `texture_reader`, `material_properties`, `material_file` (materials, images) → `scene_cameras`, `punctual_light`, `image_based_light` (what is missing is made up). A scene in motion
//! takes the same road with the numbers that an `animation` gives (`pose`: which of its triangles was which at rest). `flaws` tells authors what else is out of order.

mod accessor;
mod animation;
mod assembly;
mod attribute_name;
mod back_faces;
mod budget;
mod compressed;
mod container;
mod data_uri;
mod document;
mod error;
mod extension;
mod file_reference;
mod flaws;
mod glossy_point;
mod hierarchy;
mod image_based_light;
mod image_file;
mod inspection;
mod instancing;
mod json_object;
mod json_text;
mod load;
mod load_options;
mod material;
mod material_file;
mod material_properties;
mod material_textures;
mod mending;
mod mesh_health;
mod model;
mod own_extras;
mod own_world;
mod percent_encoding;
mod photographed;
mod picture_gloss;
mod picture_texture;
mod pose;
mod primitive;
mod punctual_light;
mod radiance_file;
mod resource;
mod scene_cameras;
mod schema;
mod skin;
mod source;
mod surface_color;
mod surface_mesh;
mod surface_point;
mod tangents;
mod texture_lookup;
mod texture_reader;
mod triangulation;
mod turned_faces;
mod variants;
mod views;
mod world;

pub use animation::{Animation, AnimationTime};
pub use back_faces::BackFaces;
pub use error::{Fault, SceneError};
pub use inspection::Inspection;
pub use load::{AnimatedScene, inspect, load, with_source};
pub use load_options::LoadOptions;
pub use material::{
    AlphaMode, Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, Material, NormalMap, Scalar, Sheen,
    TextureRef, Tint, Volume, Workflow, Wrap,
};
pub use mesh_health::MeshHealth;
pub use model::{Image, ImageLevel, Light, LightKind, Node, Part, Scene, SceneCamera, Triangle};
pub use own_extras::{CameraLens, EXTRAS_KEY, EXTRAS_VERSION};
pub use picture_gloss::PictureGloss;
pub use picture_texture::PictureTexture;
pub use pose::{PosedScene, RestTriangle};
pub use source::{GltfSource, PartSource, StoredElements};
pub use surface_mesh::SurfaceMesh;
pub use surface_point::{SurfaceField, SurfacePoint};
pub use texture_lookup::{linear_from_srgb, srgb_from_linear};
pub use views::{Mask, PhotoLookup, Photograph, PictureError, View};
pub use world::{Backdrop, Environment, EnvironmentMap, World};
