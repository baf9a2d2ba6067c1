//! The scene in memory: flat, world space, triangles only.

mod back_faces;
mod camera_lens;
mod floor;
mod inverted_faces;
mod material;
mod mesh_health;
mod placed_cloud;
mod splat_edit;

pub use back_faces::BackFaces;
pub use camera_lens::CameraLens;
pub use floor::Floor;
pub use material::{
    AlphaMode, Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, Material, NormalMap, Scalar, Sheen,
    Tint, Volume, Workflow,
};
pub use mesh_health::MeshHealth;
pub use placed_cloud::PlacedCloud;
pub use splat_edit::{SplatCleanup, SplatEdit, SplatTransform};
pub use surface::{SurfaceField, SurfacePoint, TriangleSurface};

use crate::{Image, PictureTexture, View, World};
use glam::{DMat4, DVec3, Vec2, Vec3, Vec4};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// A scene: triangles in world space with their materials, lights and cameras.
///
/// Instances are flattened: each (node, instance, primitive) is a [`Part`] with vertices of its own, so that every
/// instance can be painted separately. Vertex arrays are parallel to `positions`; the array of an attribute that no
/// part has is empty.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The file it was read from.
    pub path: PathBuf,
    /// World positions.
    pub positions: Vec<DVec3>,
    /// Unit shading normals in world space; zero if the file has none (flat shading).
    pub normals: Vec<Vec3>,
    /// Texture coordinates of sets 0 and 1 (glTF: origin at the image's upper left).
    pub uv: [Vec<Vec2>; 2],
    /// Texture coordinates of further sets that textures use: entry k corresponds to
    /// [`TextureRef::uv_set`](crate::TextureRef::uv_set) k + 2, for each part that of its own material.
    pub further_uv: Vec<Vec<Vec2>>,
    /// Linear vertex colours, multiplied into the base colour; 1 if the file has none.
    pub colors: Vec<Vec4>,
    /// Counter-clockwise seen from the front; negative scales are already undone. Those of [`Self::splats`] are last.
    pub triangles: Vec<Triangle>,
    /// For each triangle's corners the unit direction in which u of the material's normal map (or of its anisotropy)
    /// increases, and the sign of the bitangent, sign · normal × tangent; zero if a part needs none. Empty if no part
    /// does.
    pub tangents: Vec<[Vec4; 3]>,
    /// The parts that the triangles belong to, in order; their ranges cover `triangles`.
    pub parts: Vec<Part>,
    /// The nodes that have parts.
    pub nodes: Vec<Node>,
    /// Materials; the last may be glTF's default material.
    pub materials: Vec<Material>,
    /// The names of the file's variants (KHR_materials_variants), all different: alternative material assignments.
    pub variants: Vec<String>,
    /// The chosen variant, one of `variants`; `None`: the file's own materials.
    pub variant: Option<String>,
    /// Decoded images that the materials refer to.
    pub images: Vec<Image>,
    /// Lights in world space.
    pub lights: Vec<Light>,
    /// Perspective cameras in file order. Never empty: a scene without one gets a default camera that frames it.
    pub cameras: Vec<SceneCamera>,
    /// Whether the file has no camera and the first one is a default.
    pub has_default_camera: bool,
    /// Whether the backs of faces that are not double-sided are visible.
    pub back_faces: BackFaces,
    /// The world embedded in the file (EXT_lights_image_based), used unless another is chosen.
    pub embedded_world: Option<World>,
    /// The chosen world; if `None`, [`World::from_scene`] derives one.
    pub world: Option<World>,
    /// Gaussian splats.
    pub splats: Option<Arc<PlacedCloud>>,
    /// The floor that was put under it, to catch its shadows: the last part. A scene has splats or a floor.
    pub floor: Option<Floor>,
    /// The photographs that light it.
    pub views: Vec<View>,
    /// Photographs that are viewed and compared with but do not light it: excluded ones, and the views of a light
    /// field, whose light is in the texture.
    pub excluded_views: Vec<View>,
    /// For a surface that was made from a picture: the picture as its texture.
    pub picture: Option<PictureTexture>,
    /// Harmless defects of the file, a sentence each.
    pub warnings: Vec<String>,
}

/// Three corners and the part they belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    /// Indices into the vertex arrays.
    pub vertices: [u32; 3],
    /// Index into [`Scene::parts`].
    pub part: u32,
}

/// One primitive of one instance of a mesh.
#[derive(Clone, Debug)]
pub struct Part {
    /// Index into [`Scene::nodes`].
    pub node: u32,
    /// Index into [`Scene::materials`].
    pub material: u32,
    /// Its triangles.
    pub triangles: Range<u32>,
    /// Which of UV sets 0 and 1 the primitive has.
    pub has_uv: [bool; 2],
    /// Whether the transform mirrors it (its UVs are then mirrored as well).
    pub mirrored: bool,
}

/// A node (and, for EXT_mesh_gpu_instancing, one of its instances).
#[derive(Clone, Debug)]
pub struct Node {
    /// Its name in the file, or `node N`.
    pub name: String,
    /// Its index in the file.
    pub index: u32,
    /// From its own axes to the world.
    pub world: DMat4,
}

/// A punctual light in world space (KHR_lights_punctual).
#[derive(Clone, Debug)]
pub struct Light {
    /// Its name, for messages.
    pub name: String,
    /// Its kind and angular extent.
    pub kind: LightKind,
    /// Linear colour times intensity: radiant intensity (W/sr) of point and spot, irradiance of directional.
    pub intensity: Vec3,
    /// Position (not for directional lights).
    pub position: DVec3,
    /// Unit direction in which it shines.
    pub direction: DVec3,
    /// Its light ends at this distance; infinite unless the file gives a range.
    pub range: f64,
}

/// What kind of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// The same in every direction.
    Point,
    /// A cone; half angles in rad.
    Spot {
        /// Full intensity within.
        inner: f64,
        /// Nothing beyond.
        outer: f64,
    },
    /// Parallel light from infinity.
    Directional,
}

/// A perspective camera of the file.
#[derive(Clone, Debug)]
pub struct SceneCamera {
    /// Its name, or its node's, or `camera N`.
    pub name: String,
    /// Its index among the file's cameras; `None` for a default camera.
    pub index: Option<u32>,
    /// Rigid pose, glTF axes; scale of the node hierarchy removed.
    pub camera_to_world: DMat4,
    /// Full vertical angle of view, rad.
    pub yfov: f64,
    /// Width over height, if the file says so.
    pub aspect: Option<f64>,
    /// A suitable focus distance: to the first surface ahead, or the middle of the scene.
    pub focus_distance: f64,
    /// The file's settings of its lens.
    pub lens: CameraLens,
}

impl TriangleSurface for Scene {
    fn triangle_count(&self) -> usize {
        self.triangles.len()
    }
    #[inline]
    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.corners(triangle)
    }
}

impl Scene {
    /// The world positions of the corners of the triangle with this index.
    #[inline]
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let [a, b, c] = self.triangles[triangle as usize].vertices;
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// The part that the triangle with this index belongs to.
    #[inline]
    pub fn part_of(&self, triangle: u32) -> &Part {
        &self.parts[self.triangles[triangle as usize].part as usize]
    }

    /// The material of the triangle with this index.
    #[inline]
    pub fn material_of(&self, triangle: u32) -> &Material {
        &self.materials[self.part_of(triangle).material as usize]
    }

    /// Whether the back face of the triangle with this index is hidden.
    pub fn culls_back_face(&self, triangle: u32) -> bool {
        self.material_of(triangle).culls_back_faces(self.back_faces)
    }

    /// The texture coordinates of all vertices in a set ([`TextureRef::uv_set`](crate::TextureRef::uv_set)); empty if no part has it.
    #[inline]
    pub fn uv_set(&self, set: u8) -> &[Vec2] {
        let set = set as usize;
        self.uv.get(set).or_else(|| self.further_uv.get(set - self.uv.len())).map_or(&[], Vec::as_slice)
    }

    /// The texture coordinates of a triangle's corners; zero if the part has none.
    pub fn corner_uv(&self, triangle: u32, set: u8) -> [Vec2; 3] {
        let uv = self.uv_set(set);
        self.triangles[triangle as usize].vertices.map(|v| uv.get(v as usize).copied().unwrap_or_default())
    }

    /// The geometric normal of a triangle, its length twice the area; zero for a degenerate triangle.
    #[inline]
    pub fn area_normal(&self, triangle: u32) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// The lower and upper corner of the bounding box of all triangles but the floor's, and of most splats.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        self.extent().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
    }
}

/// Lengthens an attribute that some part has.
pub(crate) fn fill_attribute<T: Clone>(attribute: &mut Vec<T>, length: usize, value: T) {
    if !attribute.is_empty() {
        attribute.resize(length, value);
    }
}
