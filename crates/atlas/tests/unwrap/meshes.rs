//! Scenes made of code: sound ones and nasty ones.

use glam::{DVec3, Vec2, Vec3, Vec4};
use scene::{Material, Node, Part, Scene, Triangle};
use std::f64::consts::PI;

/// A part to be: positions, triangles and perhaps texture coordinates.
pub struct Piece {
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    pub uv: Option<Vec<Vec2>>,
}

/// A scene of a part for each piece.
pub fn scene(pieces: Vec<Piece>) -> Scene {
    let mut scene = Scene { materials: vec![material()], ..Scene::default() };
    for (part, piece) in pieces.into_iter().enumerate() {
        let (first_vertex, first) = (scene.positions.len() as u32, scene.triangles.len() as u32);
        let count = piece.positions.len();
        scene.positions.extend(piece.positions);
        scene.normals.resize(scene.positions.len(), Vec3::ZERO);
        scene.colors.resize(scene.positions.len(), Vec4::ONE);
        let has_uv = [piece.uv.is_some(), false];
        scene.uv[0].extend(piece.uv.unwrap_or_else(|| vec![Vec2::ZERO; count]));
        scene.triangles.extend(
            piece
                .triangles
                .iter()
                .map(|t| Triangle { vertices: t.map(|v| v + first_vertex), part: part as u32 }),
        );
        let triangles = first..scene.triangles.len() as u32;
        scene.parts.push(Part { node: part as u32, material: 0, triangles, has_uv, mirrored: false });
        scene.nodes.push(Node {
            name: format!("node {part}"),
            index: part as u32,
            world: glam::DMat4::IDENTITY,
        });
    }
    scene
}

fn material() -> Material {
    Material {
        name: "grey".into(),
        base_color: Vec4::new(0.5, 0.5, 0.5, 1.0),
        ..Material::lambertian_white()
    }
}

/// A sphere without a border, of 4·n·(n − 1) triangles.
pub fn sphere(n: u32, radius: f64, center: DVec3) -> Piece {
    let columns = 2 * n;
    let mut positions = vec![center + DVec3::Y * radius];
    for row in 1..n {
        for column in 0..columns {
            let (theta, phi) = (PI * f64::from(row) / f64::from(n), PI * f64::from(column) / f64::from(n));
            let d = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            positions.push(center + d * radius);
        }
    }
    positions.push(center - DVec3::Y * radius);
    let last = positions.len() as u32 - 1;
    let at = |row: u32, column: u32| match row {
        0 => 0,
        row if row == n => last,
        row => 1 + (row - 1) * columns + column % columns,
    };
    let mut triangles = Vec::new();
    for row in 0..n {
        for column in 0..columns {
            let (a, b) = (at(row, column), at(row, column + 1));
            let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
            if row > 0 {
                triangles.push([a, b, d]);
            }
            if row + 1 < n {
                triangles.push([a, d, c]);
            }
        }
    }
    Piece { positions, triangles, uv: None }
}

/// A flat grid of 2·n² triangles over the unit square times `size`, with its natural texture coordinates.
pub fn grid(n: u32, size: f64, bump: impl Fn(f64, f64) -> f64) -> Piece {
    let (mut positions, mut uv, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for (row, column) in (0..=n).flat_map(|row| (0..=n).map(move |column| (row, column))) {
        let (x, z) = (f64::from(column) / f64::from(n), f64::from(row) / f64::from(n));
        positions.push(DVec3::new(x, bump(x, z), z) * size);
        uv.push(Vec2::new(x as f32, z as f32));
        if row < n && column < n {
            let a = row * (n + 1) + column;
            triangles.extend([[a, a + n + 1, a + 1], [a + 1, a + n + 1, a + n + 2]]);
        }
    }
    Piece { positions, triangles, uv: Some(uv) }
}

/// The same piece without texture coordinates.
pub fn bare(piece: Piece) -> Piece {
    Piece { uv: None, ..piece }
}

/// The same piece mirrored in x, its triangles turned to face outwards again, as the importer does.
pub fn mirrored(piece: Piece) -> Piece {
    Piece {
        positions: piece.positions.iter().map(|p| *p * DVec3::new(-1.0, 1.0, 1.0)).collect(),
        triangles: piece.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
        uv: piece.uv,
    }
}

/// Triangles with vertices of their own.
pub fn soup(triangles: impl IntoIterator<Item = [DVec3; 3]>) -> Piece {
    let positions: Vec<DVec3> = triangles.into_iter().flatten().collect();
    let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Piece { positions, triangles, uv: None }
}
