//! Scenes for the tests, made of corners.

use glam::DVec3;
use scene::{Material, Node, Part, Scene, Triangle};
use std::sync::Arc;

pub fn white() -> Material {
    Material::unlit_white()
}

/// The same, seen from its front alone.
pub fn one_sided() -> Material {
    Material { double_sided: false, ..white() }
}

/// A mesh: positions and triangles.
pub type Mesh = (Vec<DVec3>, Vec<[u32; 3]>);

/// A scene with a part for each mesh.
pub fn scene_of(meshes: &[(Mesh, Material)]) -> Arc<Scene> {
    let mut scene = Scene {
        nodes: vec![Node { name: "node 0".into(), index: 0, world: glam::DMat4::IDENTITY }],
        ..Scene::default()
    };
    for (part, ((positions, triangles), material)) in meshes.iter().enumerate() {
        let first_vertex = scene.positions.len() as u32;
        let first = scene.triangles.len() as u32;
        scene.positions.extend(positions);
        let vertices = triangles.iter().map(|t| t.map(|v| v + first_vertex));
        scene.triangles.extend(vertices.map(|vertices| Triangle { vertices, part: part as u32 }));
        scene.parts.push(Part {
            node: 0,
            material: part as u32,
            triangles: first..scene.triangles.len() as u32,
            has_uv: [false; 2],
            mirrored: false,
        });
        scene.materials.push(material.clone());
    }
    Arc::new(scene)
}

/// The rectangle from `corner` along two sides, counter-clockwise seen from where side × other points.
pub fn rectangle(corner: DVec3, side: DVec3, other: DVec3) -> Mesh {
    (vec![corner, corner + side, corner + side + other, corner + other], vec![[0, 1, 2], [0, 2, 3]])
}

/// A sphere of `rings` × 2·`rings` quads, closed exactly: neighbours share their vertices.
pub fn sphere(center: DVec3, radius: f64, rings: u32) -> Mesh {
    let columns = 2 * rings;
    let mut positions = vec![center + DVec3::Y * radius];
    for ring in 1..rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for column in 0..columns {
            let azimuth = std::f64::consts::TAU * f64::from(column) / f64::from(columns);
            let (sin, cos) = polar.sin_cos();
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
    (positions, triangles)
}

/// Pseudo-random numbers in [0, 1): SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| 2.0 * self.unit() - 1.0))
    }

    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.in_cube();
            if (1e-3..=1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    /// Barycentrics, often on an edge or a corner.
    pub fn barycentric(&mut self) -> glam::DVec2 {
        let (mut a, mut b) = (self.unit(), self.unit());
        match (self.unit() * 6.0) as u32 {
            0 => a = 0.0,
            1 => b = 0.0,
            2 => b = 1.0 - a,
            3 => (a, b) = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)][(self.unit() * 3.0) as usize],
            _ => {}
        }
        if a + b > 1.0 { glam::DVec2::new(1.0 - a, 1.0 - b) } else { glam::DVec2::new(a, b) }
    }
}
