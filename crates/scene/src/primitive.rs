//! One primitive of a mesh: the vertices that its triangles use, morphed, in the mesh's own space.

use crate::accessor::{Accessor, Component};
use crate::document::Document;
use crate::error::Fault;
use crate::json_object::Object;
use crate::triangulation::{TRIANGLES, triangle, triangle_count};
use glam::{DVec3, Vec2, Vec4};

/// The triangles of a primitive and the vertices they use.
pub(crate) struct Primitive {
    /// JSON pointer.
    pub place: String,
    /// Index of the material in the file.
    pub material: Option<usize>,
    pub triangles: Vec<[u32; 3]>,
    pub positions: Vec<DVec3>,
    /// Empty if there are none, as the following.
    pub normals: Vec<DVec3>,
    pub uv: [Vec<Vec2>; 2],
    pub colors: Vec<Vec4>,
    /// For each vertex `influences_per_vertex` joints and their weights.
    pub influences: Vec<(u32, f64)>,
    pub influences_per_vertex: usize,
    /// What it took from the memory budget.
    memory: u64,
}

/// Bytes that a vertex with all attributes takes here, influences apart.
const VERTEX_BYTES: u64 = 4 + 24 + 24 + 2 * 8 + 16;

impl Primitive {
    /// Reads a primitive under the weights of its morph targets; `None` if it has no triangles.
    pub fn read(
        document: &Document<'_>,
        object: &Object<'_>,
        weights: &[f64],
    ) -> Result<Option<Self>, Fault> {
        /// Reading the properties takes as long as reading so many values.
        const PROPERTIES: u64 = 256;
        document.budget.work(PROPERTIES + weights.len() as u64, &object.place)?;
        let mode = object.index("mode")?.unwrap_or(TRIANGLES);
        if triangle_count(mode, 0).is_none() {
            if mode >= crate::triangulation::MODE_NAMES.len() {
                return Err(object.malformed("mode", format!("{mode} is unknown")));
            }
            return Ok(None);
        }
        if object.extension("KHR_draco_mesh_compression")?.is_some() {
            document.warn(format!(
                "{}: its Draco-compressed form is ignored, the plain one is read",
                object.place
            ));
        }
        let attributes = object.required("attributes", object.object("attributes")?)?;
        let Some(position) = attributes.index("POSITION")? else {
            document.warn(format!("{}/attributes: has no POSITION and is left out", object.place));
            return Ok(None);
        };
        let place = format!("{}/POSITION", attributes.place);
        let position = Accessor::open(document, position, &place)?.expect_components(&[3], "POSITION")?;
        let corners = corners(document, object, position.count, mode)?;
        let (triangles, vertices) = compact(&corners);
        drop(corners);
        if triangles.is_empty() {
            return Ok(None);
        }
        let memory = triangles.len() as u64 * 12 + vertices.len() as u64 * VERTEX_BYTES;
        document.budget.memory(memory, &object.place)?;
        let mut primitive = Self {
            place: object.place.clone(),
            material: object.index("material")?,
            triangles,
            positions: vertices.iter().map(|&v| DVec3::from_array(position.doubles(v as usize))).collect(),
            normals: Vec::new(),
            uv: [Vec::new(), Vec::new()],
            colors: Vec::new(),
            influences: Vec::new(),
            influences_per_vertex: 0,
            memory,
        };
        primitive.read_attributes(document, &attributes, &vertices, position.count)?;
        primitive.read_influences(document, &attributes, &vertices, position.count)?;
        primitive.morph(document, object, &vertices, position.count, weights)?;
        Ok(Some(primitive))
    }

    /// Gives its memory back.
    pub fn release(self, document: &Document<'_>) {
        document.budget.release(self.memory);
    }

    /// Normals, texture coordinates and colours. What is broken about them is left out with a warning.
    fn read_attributes(
        &mut self,
        document: &Document<'_>,
        attributes: &Object<'_>,
        vertices: &[u32],
        count: usize,
    ) -> Result<(), Fault> {
        let open =
            |name: &str, components: &[usize]| attribute(document, attributes, name, components, count);
        document.budget.work(12 * vertices.len() as u64, &attributes.place)?;
        if let Some(normal) = open("NORMAL", &[3]) {
            self.normals = vertices.iter().map(|&v| DVec3::from_array(normal.doubles(v as usize))).collect();
        }
        for (set, name) in ["TEXCOORD_0", "TEXCOORD_1"].into_iter().enumerate() {
            if let Some(uv) = open(name, &[2]) {
                let finite = |uv: Vec2| if uv.is_finite() { uv } else { Vec2::ZERO };
                self.uv[set] =
                    vertices.iter().map(|&v| finite(Vec2::from_array(uv.floats(v as usize)))).collect();
            }
        }
        if let Some(color) = open("COLOR_0", &[3, 4]) {
            let opaque = color.shape.components() == 3;
            let read = |&v: &u32| {
                let color = match opaque {
                    true => glam::Vec3::from_array(color.floats(v as usize)).extend(1.0),
                    false => Vec4::from_array(color.floats(v as usize)),
                };
                if color.is_finite() { color.max(Vec4::ZERO) } else { Vec4::ONE }
            };
            self.colors = vertices.iter().map(read).collect();
        }
        Ok(())
    }

    /// JOINTS_n and WEIGHTS_n, weights summing to 1.
    fn read_influences(
        &mut self,
        document: &Document<'_>,
        attributes: &Object<'_>,
        vertices: &[u32],
        count: usize,
    ) -> Result<(), Fault> {
        // Further sets are the exporters' exception; each is four joints.
        const MAX_SETS: usize = 4;
        let mut sets = Vec::new();
        for set in 0..MAX_SETS {
            let joints = attribute(document, attributes, &format!("JOINTS_{set}"), &[4], count);
            let weights = attribute(document, attributes, &format!("WEIGHTS_{set}"), &[4], count);
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
        document.budget.memory(16 * number, &attributes.place)?;
        self.memory += 16 * number;
        document.budget.work(2 * number, &attributes.place)?;
        self.influences.reserve_exact(number as usize);
        for &v in vertices {
            let start = self.influences.len();
            for (joints, weights) in &sets {
                let weights = weights.doubles::<4>(v as usize);
                for (i, weight) in weights.into_iter().enumerate() {
                    let weight = if weight.is_finite() { weight.max(0.0) } else { 0.0 };
                    self.influences.push((joints.stored(v as usize, i) as u32, weight));
                }
            }
            let own = &mut self.influences[start..];
            let sum: f64 = own.iter().map(|&(_, weight)| weight).sum();
            match sum {
                // A vertex that hangs on nothing hangs on its first joint.
                0.0 => own[0].1 = 1.0,
                sum => own.iter_mut().for_each(|(_, weight)| *weight /= sum),
            }
        }
        Ok(())
    }

    /// Adds the morph targets, each by its weight.
    fn morph(
        &mut self,
        document: &Document<'_>,
        object: &Object<'_>,
        vertices: &[u32],
        count: usize,
        weights: &[f64],
    ) -> Result<(), Fault> {
        for (target, &weight) in object.objects("targets")?.iter().zip(weights) {
            if weight == 0.0 {
                continue;
            }
            document.budget.work(12 * vertices.len() as u64, &target.place)?;
            let open =
                |name: &str, components: &[usize]| attribute(document, target, name, components, count);
            if let Some(index) = target.index("POSITION")? {
                let place = format!("{}/POSITION", target.place);
                let delta = Accessor::open(document, index, &place)?.expect_components(&[3], "POSITION")?;
                if delta.count < count {
                    return Err(delta.malformed(format!("has {} elements for {count} vertices", delta.count)));
                }
                for (position, &v) in self.positions.iter_mut().zip(vertices) {
                    *position += weight * DVec3::from_array(delta.doubles(v as usize));
                }
            }
            if let Some(delta) = open("NORMAL", &[3]) {
                for (normal, &v) in self.normals.iter_mut().zip(vertices) {
                    *normal += weight * DVec3::from_array(delta.doubles(v as usize));
                }
            }
            for (set, name) in ["TEXCOORD_0", "TEXCOORD_1"].into_iter().enumerate() {
                if let Some(delta) = open(name, &[2]) {
                    for (uv, &v) in self.uv[set].iter_mut().zip(vertices) {
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

/// An attribute that the picture can do without: nothing, with a warning, if it is broken.
fn attribute<'a>(
    document: &'a Document<'_>,
    attributes: &Object<'_>,
    name: &str,
    components: &[usize],
    count: usize,
) -> Option<Accessor<'a>> {
    let open = || -> Result<Option<Accessor<'a>>, Fault> {
        let Some(index) = attributes.index(name)? else { return Ok(None) };
        let place = format!("{}/{name}", attributes.place);
        let accessor = Accessor::open(document, index, &place)?.expect_components(components, name)?;
        if accessor.count < count {
            return Err(accessor.malformed(format!("has {} elements for {count} vertices", accessor.count)));
        }
        Ok(Some(accessor))
    };
    open().unwrap_or_else(|fault| {
        document.warn(format!("{}/{name}: left out, because of {fault}", attributes.place));
        None
    })
}

/// The corners of all triangles; those with a vertex that does not exist are left out with a warning.
fn corners(
    document: &Document<'_>,
    object: &Object<'_>,
    count: usize,
    mode: usize,
) -> Result<Vec<[u32; 3]>, Fault> {
    let indices = match object.index("indices")? {
        Some(index) => {
            let indices = Accessor::open(document, index, &format!("{}/indices", object.place))?;
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
    if mode == TRIANGLES && number % 3 != 0 {
        document.warn(format!(
            "{}: its {number} corners are not a multiple of 3; the rest is left out",
            object.place
        ));
    }
    document.budget.triangles(triangles as u64)?;
    document.budget.work(3 * triangles as u64, &object.place)?;
    document.budget.memory(12 * triangles as u64, &object.place)?;
    let vertex =
        |corner: usize| indices.as_ref().map_or(corner as u32, |indices| indices.stored(corner, 0) as u32);
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
            "{}/indices: {dropped} of {triangles} triangles refer to vertices beyond the {count} there are; left out",
            object.place
        ));
    }
    document.budget.release(12 * triangles as u64);
    Ok(corners)
}

/// Numbers the vertices that occur, in ascending order: the triangles in new numbers, and the old number of each.
pub(crate) fn compact(corners: &[[u32; 3]]) -> (Vec<[u32; 3]>, Vec<u32>) {
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
    use super::compact;

    #[test]
    fn compact_keeps_order_dense_or_sparse() {
        for far in [0, 4_000_000_000] {
            let (triangles, vertices) = compact(&[[7, 5, 9 + far], [5, 7, 6]]);
            assert_eq!(vertices, [5, 6, 7, 9 + far]);
            assert_eq!(triangles, [[2, 0, 3], [0, 2, 1]]);
        }
        assert_eq!(compact(&[]), (vec![], vec![]));
    }
}
