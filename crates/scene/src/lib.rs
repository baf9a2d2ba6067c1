//! glTF scenes, read safely and flattened to world-space triangles.
//!
//! * [`load`] reads a file; [`inspect`] summarises one, even without triangles;
//!   [`with_source`] gives access to the file as it is, to write it again.
//! * [`load_splats`] reads a file of Gaussian splats.
//! * [`AnimatedScene`]: the scene of a file with animations, at any [`AnimationTime`].
//! * [`Scene`]: what everything else works on; [`Scene::from_mesh`] makes one of a [`SurfaceMesh`] from elsewhere.
//! * [`PlacedCloud`]: the Gaussian splats of a scene, each with a triangle of its own.
//! * [`Floor`]: a floor that was put under a scene to catch its shadows.
//! * [`SurfacePoint`]: an address on the surface: triangle and barycentrics. The surface's appearance there:
//!   [`Scene::base_color`], [`Scene::emitted_radiance`], [`Scene::opacity`], [`Scene::shading_normal`], [`Scene::bumped_normal`].
//! * [`Material`]: the material of a surface. [`World`]: environment and backdrop.
//! * [`SurfaceField`]: anything that has a value at every surface point (focus, radiance).
//! * [`MeshHealth`]: defects of the triangles.
//! * [`View`]: a photograph with the camera that took it; its pixels are read on demand. [`open_picture`] decodes any picture.
//!
//! Files come from anywhere, so the reader trusts none: every index and byte range is checked before it is used,
//! memory, triangles and time are accounted for before they are taken, and only files inside the scene's
//! folder are opened. The document is read through the `gltf` crate, which gets a repaired copy of the JSON: integers
//! written as floats are legal, and a fault in something the picture does not need must not keep the rest from
//! opening.
//!
//! The steps of reading a file, in `gltf/`: `container` (GLB chunks, JSON text) → `repair` (typed by the
//! `gltf` crate) → `document` → `compressed` → `geometry` (`hierarchy`: which nodes, where; `primitive`: checked `accessor`s to
//! triangles,
//! morphed; `assembly`: instances and skins to world space) → `materials` (variants, textures, images) →
//! `scene_cameras`,
//! `punctual_light`, `image_based_light`. An animated scene is read in the same way with the values of an `animation`
//! (`pose`:
//! which of its triangles is which at rest). `lint` warns authors about other defects.
//!
//! # Example
//!
//! ```
//! use glam::DVec3;
//! use scene::{LoadOptions, Scene, SurfaceMesh};
//!
//! let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
//! let mesh = SurfaceMesh { positions, triangles: vec![[0, 1, 2]], ..SurfaceMesh::default() };
//! let scene = Scene::from_mesh(mesh, &LoadOptions::default()).unwrap();
//! assert_eq!(scene.area_normal(0), DVec3::Z); // its length is twice the area
//! ```

mod error;
mod floor;
mod gltf;
mod load_options;
mod model;
mod photographs;
mod picture_decoder;
mod queries;
mod splat_editing;
mod splat_file;
mod splats_in_scene;
mod surface_mesh;
mod texture;
mod world;

pub use self::gltf::{
    AnimatedScene, Animation, AnimationTime, EXTRAS_KEY, EXTRAS_VERSION, GltfSource, Inspection, PartSource,
    PosedScene, RestTriangle, StoredElements, inspect, load, with_source,
};
pub use error::{Fault, SceneError};
pub use load_options::LoadOptions;
pub use model::{
    AlphaMode, Anisotropy, BackFaces, CameraLens, Clearcoat, DiffuseTransmission, Floor, Iridescence, Light,
    LightKind, Material, MeshHealth, Node, NormalMap, Part, PlacedCloud, Scalar, Scene, SceneCamera, Sheen,
    SplatCleanup, SplatEdit, SplatTransform, SurfaceField, SurfacePoint, Tint, Triangle, TriangleSurface,
    Volume, Workflow,
};
pub use photographs::{Mask, Photograph, PictureError, PictureGloss, PictureTexture, View};
pub use picture_decoder::{MAX_PNG_EXTRAS_BYTES, open_picture};
pub use splat_file::{add_splat_file, load_splats};
pub use surface_mesh::SurfaceMesh;
pub use texture::{Image, ImageLevel, TextureRef, Wrap, linear_from_srgb, srgb_from_linear};
pub use world::{Backdrop, BuiltInEnvironment, Environment, EnvironmentMap, World};
