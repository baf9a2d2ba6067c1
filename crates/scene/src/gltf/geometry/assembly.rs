//! Transforms primitives to world space and appends them to the scene's arrays.

use crate::error::Fault;
use crate::gltf::document::Document;
use crate::gltf::geometry::primitive::{Primitive, compact_indices};
use crate::gltf::geometry::skin::blend_joints;
use crate::{Part, Scene, Triangle};
use glam::{DMat3, DMat4, DVec3, Vec2, Vec3, Vec4};
use std::iter::repeat;

/// How a primitive is transformed to world space.
pub(crate) enum Placement<'a> {
    /// As a whole, by one matrix.
    Rigid(DMat4),
    /// Each vertex by its joints.
    Skinned(&'a [DMat4]),
}

/// Larger coordinates have squares beyond the range of f32, in which rays are traced; they count as infinite.
pub(crate) const MAX_COORDINATE: f64 = 1e15;

/// Bytes that a vertex takes in the scene, doubled because growing arrays reserve space.
const VERTEX_BYTES: u64 = 2 * (24 + 12 + 8 + 8 + 16);
/// The same for an additional UV set.
const UV_BYTES: u64 = 2 * 8;

/// The vertices and triangles of a primitive that a part of the scene shows.
#[derive(Default)]
pub(crate) struct ShownElements {
    /// Its vertices, by their numbers in the primitive; empty if nothing is shown.
    pub vertices: Vec<u32>,
    /// Its triangles, likewise; `None` if all are shown.
    pub triangles: Option<Vec<u32>>,
}

/// Appends `primitive` as a part of scene node `node` with scene material `material`, and returns which of its
/// elements the part shows.
pub(crate) fn append_primitive(
    scene: &mut Scene,
    document: &Document<'_>,
    primitive: &Primitive,
    placement: &Placement<'_>,
    node: u32,
    material: u32,
) -> Result<ShownElements, Fault> {
    let vertices = primitive.positions.len();
    let passing = vertices as u64 * if matches!(placement, Placement::Skinned(_)) { 128 + 32 } else { 32 };
    let further_sets = scene.further_uv.len().max(primitive.further_uv.len());
    // A set that is new to the scene also takes memory for the vertices before it.
    let padding = (further_sets - scene.further_uv.len()) as u64 * UV_BYTES * scene.positions.len() as u64;
    let vertex_bytes = VERTEX_BYTES + further_sets as u64 * UV_BYTES;
    // Tangents that are new to the scene also take memory for the triangles before them.
    let has_tangents = !(scene.tangents.is_empty() && primitive.tangents.is_empty());
    let untouched = if scene.tangents.is_empty() { scene.triangles.len() as u64 } else { 0 };
    let tangent_bytes = if has_tangents { 96 * (primitive.triangles.len() as u64 + untouched) } else { 0 };
    let triangle_bytes = primitive.triangles.len() as u64 * 33 + tangent_bytes;
    let lasting = vertices as u64 * vertex_bytes + triangle_bytes + padding;
    document.budget.take_memory(passing + lasting, &primitive.place)?;
    document.budget.take_work(16 * vertices as u64, &primitive.place)?;
    let matrices: Vec<DMat4> = match placement {
        Placement::Rigid(matrix) => vec![*matrix],
        Placement::Skinned(joints) => {
            let influences = primitive.influences.chunks_exact(primitive.influences_per_vertex.max(1));
            influences.map(|influences| blend_joints(joints, influences)).collect()
        }
    };
    let matrix = |v: usize| if matrices.len() == 1 { &matrices[0] } else { &matrices[v] };
    let world: Vec<DVec3> =
        (0..vertices).map(|v| matrix(v).transform_point3(primitive.positions[v])).collect();

    let is_usable =
        |&v: &u32| world[v as usize].abs().max_element() <= MAX_COORDINATE && world[v as usize].is_finite();
    let is_valid: Vec<bool> = primitive.triangles.iter().map(|t| t.iter().all(is_usable)).collect();
    let is_valid_triangle = |i: &usize| is_valid[*i];
    let valid_triangles: Vec<[u32; 3]> =
        (0..is_valid.len()).filter(is_valid_triangle).map(|triangle| primitive.triangles[triangle]).collect();
    if valid_triangles.len() < primitive.triangles.len() {
        let (dropped, all) = (primitive.triangles.len() - valid_triangles.len(), primitive.triangles.len());
        document.warn(format!(
            "{}: {dropped} of {all} triangles have infinite, undefined or absurdly large positions; left out",
            primitive.place
        ));
    }
    let (triangles, used) = match valid_triangles.len() == primitive.triangles.len() {
        true => (valid_triangles, (0..vertices as u32).collect()),
        false => compact_indices(&valid_triangles),
    };
    if triangles.is_empty() {
        document.budget.release_memory(passing + lasting);
        return Ok(ShownElements::default());
    }

    let mirrors = |matrix: &DMat4| matrix.determinant() < 0.0;
    let mirrored = 2 * matrices.iter().filter(|matrix| mirrors(matrix)).count() > matrices.len();
    let base = scene.positions.len();
    let part = scene.parts.len() as u32;
    let first = scene.triangles.len() as u32;
    scene.positions.extend(used.iter().map(|&v| world[v as usize]));
    let end = scene.positions.len();
    let normal = |v: usize| world_normal(matrix(v), primitive.normals[v]);
    extend_attribute(&mut scene.normals, !primitive.normals.is_empty(), Vec3::ZERO, base, end, &used, normal);
    scene.further_uv.resize(further_sets, Vec::new());
    let none = Vec::new();
    let further = scene.further_uv.iter_mut().zip(primitive.further_uv.iter().chain(repeat(&none)));
    for (uv, source) in scene.uv.iter_mut().zip(&primitive.uv).chain(further) {
        extend_attribute(uv, !source.is_empty(), Vec2::ZERO, base, end, &used, |v| source[v]);
    }
    let colors = &primitive.colors;
    extend_attribute(&mut scene.colors, !colors.is_empty(), Vec4::ONE, base, end, &used, |v| colors[v]);
    if has_tangents {
        scene.tangents.resize(first as usize, [Vec4::ZERO; 3]);
        let world_tangents = |triangle: usize| {
            let (corners, vertices) = (primitive.tangents[triangle], primitive.triangles[triangle]);
            let [a, b, c] =
                [0, 1, 2].map(|corner| world_tangent(matrix(vertices[corner] as usize), corners[corner]));
            if mirrored { [a, c, b] } else { [a, b, c] }
        };
        let valid = (0..primitive.tangents.len()).filter(|&triangle| is_valid[triangle]);
        scene.tangents.extend(valid.map(world_tangents));
        scene.tangents.resize(first as usize + triangles.len(), [Vec4::ZERO; 3]);
    }
    scene.triangles.extend(triangles.into_iter().map(|[a, b, c]| {
        let vertices = if mirrored { [a, c, b] } else { [a, b, c] };
        Triangle { vertices: vertices.map(|v| base as u32 + v), part }
    }));
    scene.parts.push(Part {
        node,
        material,
        triangles: first..scene.triangles.len() as u32,
        has_uv: [0, 1].map(|set| !primitive.uv[set].is_empty()),
        mirrored,
    });
    document.budget.release_memory(passing);
    let all = is_valid.iter().all(|&is_valid| is_valid);
    let numbers =
        || (0..).zip(&is_valid).filter(|(_, is_valid)| **is_valid).map(|(number, _)| number).collect();
    Ok(ShownElements { vertices: used, triangles: (!all).then(numbers) })
}

/// Appends an attribute of the used vertices, or its default. An attribute that no part has so far stays empty.
fn extend_attribute<T: Clone>(
    array: &mut Vec<T>,
    present: bool,
    default: T,
    base: usize,
    end: usize,
    used: &[u32],
    value: impl Fn(usize) -> T,
) {
    if present {
        array.resize(base, default);
        array.extend(used.iter().map(|&v| value(v as usize)));
    } else if !array.is_empty() {
        array.resize(end, default);
    }
}

/// A unit normal in world space: by the inverse transpose, computed as the cofactor matrix, which also exists for
/// singular matrices; its sign is that of the determinant. Zero if undefined.
fn world_normal(matrix: &DMat4, normal: DVec3) -> Vec3 {
    let m = DMat3::from_mat4(*matrix);
    let cofactors =
        DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    (sign * (cofactors * normal)).try_normalize().unwrap_or_default().as_vec3()
}

/// A tangent in world space. A mirroring matrix flips normals, so the bitangent changes sign.
fn world_tangent(matrix: &DMat4, tangent: Vec4) -> Vec4 {
    let along = matrix.transform_vector3(tangent.truncate().as_dvec3()).normalize_or_zero();
    let sign = if matrix.determinant() < 0.0 { -1.0 } else { 1.0 };
    along.as_vec3().extend(if along == DVec3::ZERO { 0.0 } else { sign * tangent.w })
}
