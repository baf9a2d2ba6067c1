//! One primitive of a mesh: the vertices that its triangles use, morphed, in the mesh's own space.

use crate::error::Fault;
use crate::gltf::document::Document;
use crate::gltf::geometry::accessor::{Accessor, Component};
use crate::gltf::geometry::tangents;
use crate::gltf::geometry::triangulation::{triangle, triangle_count};
use crate::gltf::materials::texture_info::{TextureInfo, further_uv_sets, tangent_texture};
use crate::gltf::materials::variants::Variants;
use glam::{DVec3, Vec2, Vec4};
use gltf::mesh::{Mode, Semantic};

/// The triangles of a primitive and the vertices they use.
pub(crate) struct Primitive {
    /// JSON pointer.
    pub place: String,
    /// Index of the material in the file, in the chosen variant.
    pub material: Option<usize>,
    pub triangles: Vec<[u32; 3]>,
    /// For each vertex, its element in the accessors.
    pub elements: Vec<u32>,
    pub positions: Vec<DVec3>,
    /// Empty if there are none; so are the following.
    pub normals: Vec<DVec3>,
    pub uv: [Vec<Vec2>; 2],
    /// Of the further sets that its material uses, in that order.
    pub further_uv: Vec<Vec<Vec2>>,
    pub colors: Vec<Vec4>,
    /// For the triangles' corners, the direction of u and the sign of the bitangent; empty if the material needs
    /// none.
    pub tangents: Vec<[Vec4; 3]>,
    /// For each vertex `influences_per_vertex` joints and their weights.
    pub influences: Vec<(u32, f64)>,
    pub influences_per_vertex: usize,
    /// Bytes taken from the memory budget.
    memory: u64,
}

/// Bytes that a vertex with all attributes takes here, without influences.
const VERTEX_BYTES: u64 = 4 + 24 + 24 + 2 * 8 + 16;

impl Primitive {
    /// Reads a primitive in a variant with the weights of its morph targets; `None` if it has no triangles.
    ///
    /// # Errors
    /// The primitive or its accessors are faulty, or the budget is exhausted.
    pub fn read(
        document: &Document<'_>,
        file: &gltf::Primitive<'_>,
        place: &str,
        variants: &Variants,
        weights: &[f64],
    ) -> Result<Option<Self>, Fault> {
        /// Reading the properties takes as long as reading this many values.
        const PROPERTIES: u64 = 256;
        document.budget.take_work(PROPERTIES + weights.len() as u64, place)?;
        document.check_at(place)?;
        document.check_at(&format!("{place}/mode"))?;
        let mode = file.mode();
        if triangle_count(mode, 0).is_none() {
            return Ok(None);
        }
        document.check_at(&format!("{place}/extensions"))?;
        document.check_below(&format!("{place}/extensions/KHR_draco_mesh_compression"))?;
        let attributes = Attributes { document, file, place: format!("{place}/attributes") };
        document.check_at(&attributes.place)?;
        let position_place = format!("{}/POSITION", attributes.place);
        document.check_at(&position_place)?;
        let Some(position) = file.get(&Semantic::Positions) else {
            document.warn(format!("{}: has no POSITION and is left out", attributes.place));
            return Ok(None);
        };
        let position = Accessor::open(document, position.index(), &position_place)?;
        let position = position.expect_components(&[3], "POSITION")?;
        let material = match variants.material(document, place)? {
            Some(material) => Some(material),
            None => {
                document.check_at(&format!("{place}/material"))?;
                file.material().index()
            }
        };
        let corners = read_corners(document, file, place, position.count)?;
        let (triangles, vertices) = compact_indices(&corners);
        drop(corners);
        if triangles.is_empty() {
            return Ok(None);
        }
        let further_sets = further_uv_sets(document, material);
        let vertex_bytes = VERTEX_BYTES + 8 * further_sets.len() as u64;
        let memory = triangles.len() as u64 * 12 + vertices.len() as u64 * vertex_bytes;
        document.budget.take_memory(memory, place)?;
        let mut primitive = Self {
            place: place.into(),
            material,
            triangles,
            elements: Vec::new(),
            positions: vertices.iter().map(|&v| DVec3::from_array(position.doubles(v as usize))).collect(),
            normals: Vec::new(),
            uv: [Vec::new(), Vec::new()],
            further_uv: vec![Vec::new(); further_sets.len()],
            colors: Vec::new(),
            tangents: Vec::new(),
            influences: Vec::new(),
            influences_per_vertex: 0,
            memory,
        };
        primitive.read_attributes(&attributes, &vertices, position.count)?;
        primitive.read_uv(&attributes, &further_sets, &vertices, position.count)?;
        primitive.read_influences(&attributes, &vertices, position.count)?;
        primitive.morph(document, file, &further_sets, &vertices, position.count, weights)?;
        if let Some(texture) = tangent_texture(document, material) {
            primitive.read_tangents(&attributes, &texture, &further_sets, &vertices, position.count)?;
        }
        primitive.elements = vertices;
        Ok(Some(primitive))
    }

    /// Returns the memory that it takes to the budget.
    pub fn release(self, document: &Document<'_>) {
        document.budget.release_memory(self.memory);
    }

    /// Reads normals and colours. Broken ones are left out with a warning.
    fn read_attributes(
        &mut self,
        attributes: &Attributes<'_>,
        vertices: &[u32],
        count: usize,
    ) -> Result<(), Fault> {
        let open = |semantic, components: &[usize]| attributes.open(&semantic, components, count);
        attributes.document.budget.take_work(8 * vertices.len() as u64, &attributes.place)?;
        if let Some(normal) = open(Semantic::Normals, &[3]) {
            self.normals = vertices.iter().map(|&v| DVec3::from_array(normal.doubles(v as usize))).collect();
        }
        if let Some(color) = open(Semantic::Colors(0), &[3, 4]) {
            let opaque = color.shape.components() == 3;
            let read_color = |&v: &u32| {
                let color = match opaque {
                    true => glam::Vec3::from_array(color.floats(v as usize)).extend(1.0),
                    false => Vec4::from_array(color.floats(v as usize)),
                };
                if color.is_finite() { color.max(Vec4::ZERO) } else { Vec4::ONE }
            };
            self.colors = vertices.iter().map(read_color).collect();
        }
        Ok(())
    }

    /// Reads texture coordinates. A broken set is left out with a warning.
    fn read_uv(
        &mut self,
        attributes: &Attributes<'_>,
        further_sets: &[u32],
        vertices: &[u32],
        count: usize,
    ) -> Result<(), Fault> {
        let work = 2 * (2 + further_sets.len()) as u64 * vertices.len() as u64;
        attributes.document.budget.take_work(work, &attributes.place)?;
        for (set, uvs) in self.uv_sets(further_sets) {
            if let Some(uv) = attributes.open(&Semantic::TexCoords(set), &[2], count) {
                let finite = |uv: Vec2| if uv.is_finite() { uv } else { Vec2::ZERO };
                *uvs = vertices.iter().map(|&v| finite(Vec2::from_array(uv.floats(v as usize)))).collect();
            }
        }
        Ok(())
    }

    /// Reads the file's tangents, which belong to its normals, or generates them for the texture coordinates of
    /// `texture`.
    fn read_tangents(
        &mut self,
        attributes: &Attributes<'_>,
        texture: &TextureInfo,
        further_sets: &[u32],
        vertices: &[u32],
        count: usize,
    ) -> Result<(), Fault> {
        let (document, triangles) = (attributes.document, self.triangles.len() as u64);
        document.budget.take_memory(48 * triangles, &attributes.place)?;
        self.memory += 48 * triangles;
        document.budget.take_work(4 * vertices.len() as u64 + 64 * triangles, &attributes.place)?;
        let file_tangents =
            attributes.open(&Semantic::Tangents, &[4], count).filter(|_| !self.normals.is_empty());
        if let Some(own) = file_tangents {
            let tangent = |v: u32| Vec4::from_array(own.floats(vertices[v as usize] as usize));
            let finite = |tangent: Vec4| if tangent.is_finite() { tangent } else { Vec4::ZERO };
            self.tangents =
                self.triangles.iter().map(|corners| corners.map(|v| finite(tangent(v)))).collect();
            return Ok(());
        }
        let uv = match usize::from(texture.uv_set(further_sets)) {
            set @ (0 | 1) => &self.uv[set],
            set => &self.further_uv[set - 2],
        };
        document.budget.take_memory(tangents::BYTES_PER_TRIANGLE * triangles, &attributes.place)?;
        self.tangents = tangents::generate(tangents::TangentInput {
            triangles: &self.triangles,
            positions: &self.positions,
            normals: &self.normals,
            uv,
            transform: texture.transform,
        });
        document.budget.release_memory(tangents::BYTES_PER_TRIANGLE * triangles);
        Ok(())
    }

    /// The texture coordinates with the numbers of their sets.
    fn uv_sets(&mut self, further_sets: &[u32]) -> impl Iterator<Item = (u32, &mut Vec<Vec2>)> {
        [0, 1]
            .into_iter()
            .chain(further_sets.iter().copied())
            .zip(self.uv.iter_mut().chain(&mut self.further_uv))
    }

    /// Reads JOINTS_n and WEIGHTS_n; weights are normalised to sum to 1.
    fn read_influences(
        &mut self,
        attributes: &Attributes<'_>,
        vertices: &[u32],
        count: usize,
    ) -> Result<(), Fault> {
        // Further sets are rare; each is four joints.
        const MAX_SETS: u32 = 4;
        let document = attributes.document;
        let mut sets = Vec::new();
        for set in 0..MAX_SETS {
            let joints = attributes.open(&Semantic::Joints(set), &[4], count);
            let weights = attributes.open(&Semantic::Weights(set), &[4], count);
            let (Some(joints), Some(weights)) = (joints, weights) else { break };
            if !matches!(joints.component, Component::U8 | Component::U16) {
                document.warn(format!("{}: joints cannot be of this type; left out", joints.place));
                break;
            }
            sets.push((joints, weights));
        }
        if sets.is_empty() {
            return Ok(());
        }
        self.influences_per_vertex = 4 * sets.len();
        let number = (self.influences_per_vertex * vertices.len()) as u64;
        document.budget.take_memory(16 * number, &attributes.place)?;
        self.memory += 16 * number;
        document.budget.take_work(2 * number, &attributes.place)?;
        self.influences.reserve_exact(number as usize);
        for &v in vertices {
            let start = self.influences.len();
            for (joints, weights) in &sets {
                let weights = weights.doubles::<4>(v as usize);
                for (i, weight) in weights.into_iter().enumerate() {
                    let weight = if weight.is_finite() { weight.max(0.0) } else { 0.0 };
                    self.influences.push((joints.raw_value(v as usize, i) as u32, weight));
                }
            }
            let vertex_influences = &mut self.influences[start..];
            let sum: f64 = vertex_influences.iter().map(|&(_, weight)| weight).sum();
            match sum {
                // A vertex without weights follows its first joint.
                0.0 => vertex_influences[0].1 = 1.0,
                sum => vertex_influences.iter_mut().for_each(|(_, weight)| *weight /= sum),
            }
        }
        Ok(())
    }

    /// Adds the weighted morph targets.
    fn morph(
        &mut self,
        document: &Document<'_>,
        file: &gltf::Primitive<'_>,
        further_sets: &[u32],
        vertices: &[u32],
        count: usize,
        weights: &[f64],
    ) -> Result<(), Fault> {
        let place = format!("{}/targets", self.place);
        document.check_at(&place)?;
        for ((i, target), &weight) in file.morph_targets().enumerate().zip(weights) {
            let place = format!("{place}/{i}");
            document.check_at(&place)?;
            if weight == 0.0 {
                continue;
            }
            document
                .budget
                .take_work((12 + 2 * further_sets.len() as u64) * vertices.len() as u64, &place)?;
            let open = |name: &str, components: &[usize]| {
                // The typed targets lack texture coordinates and colours.
                let place = format!("{place}/{name}");
                open_attribute(document, document.index_at(&place), &place, name, components, count)
            };
            let position_place = format!("{place}/POSITION");
            document.check_at(&position_place)?;
            if let Some(delta) = target.positions() {
                let delta = Accessor::open(document, delta.index(), &position_place)?;
                let delta = delta.expect_components(&[3], "POSITION")?;
                if delta.count < count {
                    return Err(delta.malformed(format!("has {} elements for {count} vertices", delta.count)));
                }
                for (position, &v) in self.positions.iter_mut().zip(vertices) {
                    *position += weight * DVec3::from_array(delta.doubles(v as usize));
                }
            }
            let normal_place = format!("{place}/NORMAL");
            let normals = target.normals().map(|normals| normals.index());
            if let Some(delta) = open_attribute(document, normals, &normal_place, "NORMAL", &[3], count) {
                for (normal, &v) in self.normals.iter_mut().zip(vertices) {
                    *normal += weight * DVec3::from_array(delta.doubles(v as usize));
                }
            }
            for (set, uvs) in self.uv_sets(further_sets) {
                if let Some(delta) = open(&format!("TEXCOORD_{set}"), &[2]) {
                    for (uv, &v) in uvs.iter_mut().zip(vertices) {
                        *uv += weight as f32 * Vec2::from_array(delta.floats(v as usize));
                    }
                }
            }
            if let Some(delta) = open("COLOR_0", &[3, 4]) {
                let opaque = delta.shape.components() == 3;
                for (color, &v) in self.colors.iter_mut().zip(vertices) {
                    let delta = match opaque {
                        true => glam::Vec3::from_array(delta.floats(v as usize)).extend(0.0),
                        false => Vec4::from_array(delta.floats(v as usize)),
                    };
                    *color = (*color + weight as f32 * delta).clamp(Vec4::ZERO, Vec4::ONE);
                }
            }
        }
        Ok(())
    }
}

/// All triangles of a primitive whose vertices exist, as elements of its accessors.
pub(crate) fn read_triangles(
    document: &Document<'_>,
    file: &gltf::Primitive<'_>,
    place: &str,
) -> Result<Vec<[u32; 3]>, Fault> {
    match file.get(&Semantic::Positions) {
        Some(position) if triangle_count(file.mode(), 0).is_some() => {
            read_corners(document, file, place, position.count())
        }
        _ => Ok(Vec::new()),
    }
}

/// The attributes of a primitive.
struct Attributes<'a> {
    document: &'a Document<'a>,
    file: &'a gltf::Primitive<'a>,
    /// JSON pointer.
    place: String,
}

impl<'a> Attributes<'a> {
    /// An optional attribute.
    fn open(&self, semantic: &Semantic, components: &[usize], count: usize) -> Option<Accessor<'a>> {
        let index = self.file.get(semantic).map(|accessor| accessor.index());
        let name = semantic.to_string();
        open_attribute(self.document, index, &format!("{}/{name}", self.place), &name, components, count)
    }
}

/// An optional attribute: `None`, with a warning, if it is broken.
fn open_attribute<'a>(
    document: &'a Document<'_>,
    index: Option<usize>,
    place: &str,
    name: &str,
    components: &[usize],
    count: usize,
) -> Option<Accessor<'a>> {
    let open = || -> Result<Option<Accessor<'a>>, Fault> {
        document.check_at(place)?;
        let Some(index) = index else { return Ok(None) };
        let accessor = Accessor::open(document, index, place)?.expect_components(components, name)?;
        if accessor.count < count {
            return Err(accessor.malformed(format!("has {} elements for {count} vertices", accessor.count)));
        }
        Ok(Some(accessor))
    };
    open().unwrap_or_else(|fault| {
        document.warn(format!("{place}: left out, because of {fault}"));
        None
    })
}

/// The corners of all triangles; triangles with a vertex that does not exist are left out with a warning.
fn read_corners(
    document: &Document<'_>,
    file: &gltf::Primitive<'_>,
    place: &str,
    count: usize,
) -> Result<Vec<[u32; 3]>, Fault> {
    let (mode, indices_place) = (file.mode(), format!("{place}/indices"));
    document.check_at(&indices_place)?;
    let indices = match file.indices() {
        Some(indices) => {
            let indices = Accessor::open(document, indices.index(), &indices_place)?;
            let indices = indices.expect_components(&[1], "indices")?;
            if !matches!(indices.component, Component::U8 | Component::U16 | Component::U32) {
                return Err(indices.malformed("indices must be unsigned integers"));
            }
            Some(indices)
        }
        None => None,
    };
    let number = indices.as_ref().map_or(count, |indices| indices.count);
    let triangles = triangle_count(mode, number).unwrap_or(0);
    if mode == Mode::Triangles && number % 3 != 0 {
        document.warn(format!("{place}: its {number} corners are not a multiple of 3; the rest is left out"));
    }
    document.budget.take_triangles(triangles as u64)?;
    document.budget.take_work(3 * triangles as u64, place)?;
    document.budget.take_memory(12 * triangles as u64, place)?;
    let vertex =
        |corner: usize| indices.as_ref().map_or(corner as u32, |indices| indices.raw_value(corner, 0) as u32);
    let mut corners = Vec::with_capacity(triangles);
    for i in 0..triangles {
        let corner = triangle(mode, i).map(vertex);
        if corner.iter().all(|&v| (v as usize) < count) {
            corners.push(corner);
        }
    }
    if corners.len() < triangles {
        let dropped = triangles - corners.len();
        document.warn(format!(
            "{indices_place}: {dropped} of {triangles} triangles refer to vertices beyond the {count} there are; left out"
        ));
    }
    document.budget.release_memory(12 * triangles as u64);
    Ok(corners)
}

/// Renumbers the vertices in use, in ascending order: the triangles in new numbers, and the old number of each.
pub(crate) fn compact_indices(corners: &[[u32; 3]]) -> (Vec<[u32; 3]>, Vec<u32>) {
    let all = || corners.iter().flatten().copied();
    let (Some(low), Some(high)) = (all().min(), all().max()) else { return (Vec::new(), Vec::new()) };
    let span = (high - low) as usize + 1;
    if span > 8 * corners.len() {
        // A few corners scattered over a large accessor.
        let mut vertices: Vec<u32> = all().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let number = |v: u32| vertices.partition_point(|&other| other < v) as u32;
        return (corners.iter().map(|corner| corner.map(number)).collect(), vertices);
    }
    const UNUSED: u32 = u32::MAX;
    let mut number = vec![UNUSED; span];
    all().for_each(|v| number[(v - low) as usize] = 0);
    let mut vertices = Vec::new();
    for (offset, number) in number.iter_mut().enumerate().filter(|(_, number)| **number != UNUSED) {
        *number = vertices.len() as u32;
        vertices.push(low + offset as u32);
    }
    (corners.iter().map(|corner| corner.map(|v| number[(v - low) as usize])).collect(), vertices)
}

#[cfg(test)]
mod tests {
    use super::compact_indices;

    #[test]
    fn compact_keeps_order_dense_or_sparse() {
        for far in [0, 4_000_000_000] {
            let (triangles, vertices) = compact_indices(&[[7, 5, 9 + far], [5, 7, 6]]);
            assert_eq!(vertices, [5, 6, 7, 9 + far]);
            assert_eq!(triangles, [[2, 0, 3], [0, 2, 1]]);
        }
        assert_eq!(compact_indices(&[]), (vec![], vec![]));
    }
}
