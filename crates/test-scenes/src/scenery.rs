//! Procedural scenes. The camera of most cases is at the origin and looks along −z.

use glam::{DVec3, Vec4};
use scene::{Material, Node, Part, Scene, Triangle};
use std::borrow::Borrow;
use std::sync::Arc;

/// A mesh.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The vertices.
    pub positions: Vec<DVec3>,
    /// Indices into the vertices, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A single triangle.
    pub fn triangle(corners: [DVec3; 3]) -> Self {
        Self { positions: corners.to_vec(), triangles: vec![[0, 1, 2]] }
    }

    /// The parallelogram at `corner` with two sides; the front faces along side × other.
    pub fn rectangle(corner: DVec3, side: DVec3, other: DVec3) -> Self {
        let positions = vec![corner, corner + side, corner + side + other, corner + other];
        Self { positions, triangles: vec![[0, 1, 2], [0, 2, 3]] }
    }

    /// A square facing the camera at the given depth, centred on the axis.
    pub fn wall(depth: f64, half: f64) -> Self {
        Self::rectangle(DVec3::new(-half, -half, -depth), DVec3::X * 2.0 * half, DVec3::Y * 2.0 * half)
    }

    /// A box between two corners, with its front outside.
    pub fn cuboid(low: DVec3, high: DVec3) -> Self {
        let size = high - low;
        let [x, y, z] = [DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z];
        let faces = [(high, -z, -x), (low, x, z), (low, y, x), (high, -x, -y), (low, z, y), (high, -y, -z)];
        faces
            .into_iter()
            .fold(Self::default(), |all, (corner, side, other)| all.and(Self::rectangle(corner, side, other)))
    }

    /// The union with another mesh.
    pub fn and(mut self, other: Self) -> Self {
        let first = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.triangles.extend(other.triangles.into_iter().map(|corners| corners.map(|v| v + first)));
        self
    }

    /// The mesh with reversed orientation.
    pub fn turned(mut self) -> Self {
        self.triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
        self
    }

    /// A watertight sphere of `rings` × 2·`rings` quads: neighbours share their vertices.
    pub fn sphere(center: DVec3, radius: f64, rings: u32) -> Self {
        let columns = 2 * rings;
        let mut positions = vec![center + DVec3::Y * radius];
        for ring in 1..rings {
            let (sin, cos) = (std::f64::consts::PI * f64::from(ring) / f64::from(rings)).sin_cos();
            for column in 0..columns {
                let azimuth = std::f64::consts::TAU * f64::from(column) / f64::from(columns);
                positions.push(center + radius * DVec3::new(sin * azimuth.cos(), cos, -sin * azimuth.sin()));
            }
        }
        let south = positions.len() as u32;
        positions.push(center - DVec3::Y * radius);
        let at = |ring: u32, column: u32| 1 + (ring - 1) * columns + column % columns;
        let mut triangles = Vec::new();
        for column in 0..columns {
            triangles.push([0, at(1, column), at(1, column + 1)]);
            for ring in 1..rings - 1 {
                let [a, b] = [at(ring, column), at(ring + 1, column)];
                let [c, d] = [at(ring + 1, column + 1), at(ring, column + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
            triangles.push([south, at(rings - 1, column + 1), at(rings - 1, column)]);
        }
        Self { positions, triangles }
    }

    /// The mesh with every coordinate multiplied.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.positions.iter_mut().for_each(|p| *p *= factor);
        self
    }
}

/// An unlit white material, double-sided.
pub fn white() -> Material {
    Material::unlit_white()
}

/// An unlit white material that is visible from its front only.
pub fn one_sided() -> Material {
    Material { double_sided: false, ..white() }
}

/// An unlit material of this radiance, double-sided.
pub fn unlit([red, green, blue]: [f32; 3]) -> Material {
    Material { base_color: Vec4::new(red, green, blue, 1.0), ..white() }
}

/// A scene in which each mesh is a separate part and node, unlit with the given radiance and double-sided.
pub fn unlit_scene_of<'a>(meshes: impl IntoIterator<Item = (&'a Mesh, [f32; 3])>) -> Arc<Scene> {
    scene_of(meshes.into_iter().map(|(mesh, radiance)| (mesh, unlit(radiance))))
}

/// A scene in which each mesh is a separate part and node with the given material.
pub fn scene_of(meshes: impl IntoIterator<Item = (impl Borrow<Mesh>, Material)>) -> Arc<Scene> {
    let mut scene = Scene::default();
    for (index, (mesh, material)) in meshes.into_iter().enumerate() {
        let mesh = mesh.borrow();
        let first_vertex = scene.positions.len() as u32;
        let first = scene.triangles.len() as u32;
        let index = index as u32;
        scene.positions.extend(&mesh.positions);
        let corners = mesh.triangles.iter().map(|t| t.map(|v| v + first_vertex));
        scene.triangles.extend(corners.map(|vertices| Triangle { vertices, part: index }));
        scene.nodes.push(Node { name: format!("node {index}"), index, world: glam::DMat4::IDENTITY });
        scene.parts.push(Part {
            node: index,
            material: index,
            triangles: first..scene.triangles.len() as u32,
            has_uv: [false; 2],
            mirrored: false,
        });
        scene.materials.push(Material { name: format!("material {index}"), ..material });
    }
    Arc::new(scene)
}
