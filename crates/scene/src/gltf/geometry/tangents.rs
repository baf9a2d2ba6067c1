//! Tangents: the direction in which a texture's u increases on the surface, as needed by normal maps and anisotropy.
//!
//! The file's own, or MikkTSpace's if it has none, with which normal maps are baked. They belong to the corners of
//! triangles, since two triangles that share a vertex may be mirrored in the texture.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{DVec3, Mat3, Vec2, Vec3, Vec4};

/// Approximate bytes per triangle while tangents are generated.
pub(crate) const BYTES_PER_TRIANGLE: u64 = 400;

/// The input of tangent generation.
pub(crate) struct TangentInput<'a> {
    pub triangles: &'a [[u32; 3]],
    pub positions: &'a [DVec3],
    /// Empty if there are none.
    pub normals: &'a [DVec3],
    /// Texture coordinates of the texture that they are for.
    pub uv: &'a [Vec2],
    /// Transform of that texture.
    pub transform: Mat3,
}

/// A mesh with MikkTSpace's interface.
struct TangentGenerator<'a> {
    mesh: TangentInput<'a>,
    tangents: Vec<[Vec4; 3]>,
}

/// Tangents at the corners of a mesh's triangles by MikkTSpace: unit vectors with the sign of the bitangent, normal ×
/// tangent · sign. Zero where undefined.
pub(crate) fn generate(mesh: TangentInput<'_>) -> Vec<[Vec4; 3]> {
    let tangents = vec![[Vec4::ZERO; 3]; mesh.triangles.len()];
    if mesh.uv.is_empty() {
        return tangents;
    }
    let mut work = TangentGenerator { mesh, tangents };
    // It fails only for an empty mesh.
    let _ = generate_tangents(&mut work);
    work.tangents
}

impl TangentGenerator<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }
}

impl Geometry for TangentGenerator<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].as_vec3().to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        let normals = &self.mesh.normals;
        let normal = if normals.is_empty() {
            let [a, b, c] = [0, 1, 2].map(|corner| self.mesh.positions[self.vertex(face, corner)]);
            (b - a).cross(c - a)
        } else {
            normals[self.vertex(face, corner)]
        };
        normal.normalize_or_zero().as_vec3().to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uv = self.mesh.transform * self.mesh.uv[self.vertex(face, corner)].extend(1.0);
        // MikkTSpace has v upwards, as normal maps do.
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let tangent = space.map_or(Vec4::ZERO, |space| Vec4::from_array(space.tangent_encoded()));
        let is_usable = tangent.is_finite() && tangent.truncate() != Vec3::ZERO;
        self.tangents[face][corner] = if is_usable { tangent } else { Vec4::ZERO };
    }
}
