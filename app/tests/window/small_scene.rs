//! A scene for tests: an unlit chequered wall at distance 5 and a card in front of its left half, at distance
//! 2.

use crate::acting::Person;
use serde_json::{Value, json};
use std::path::Path;

/// Chequers per side of the wall.
const FIELDS: u32 = 10;

/// Opens the window on the scene, in a folder of its own.
pub fn opened() -> (Person, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wall.glb");
    write(&file);
    (Person::opens(&file), folder)
}

/// The same with a bar, 2 px wide, at the centre of the card instead of it.
pub fn opened_with_bar() -> (Person, tempfile::TempDir, glam::DVec3) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bar.glb");
    write_before(&file, [0.3, -0.35], [0.008, 0.7]);
    (Person::opens(&file), folder, glam::DVec3::new(0.304, 0.0, -2.0))
}

/// Writes the scene as GLB.
pub fn write(file: &Path) {
    write_before(file, [-0.9, -0.35], [0.7; 2]);
}

/// The wall with another object in front of it.
fn write_before(file: &Path, [left, low]: [f32; 2], size: [f32; 2]) {
    let card = ([left, low, -2.0], size);
    let mut mesh = Mesh::default();
    let size = 6.0 / FIELDS as f32;
    for row in 0..FIELDS {
        for column in 0..FIELDS {
            let (x, y) = (-3.0 + column as f32 * size, -3.0 + row as f32 * size);
            let bright = if (row + column) % 2 == 0 { 0.85 } else { 0.1 };
            mesh.quad([x, y, -5.0], [size; 2], [bright, bright * 0.9, bright * 0.7]);
        }
    }
    let wall = mesh.indices.len();
    mesh.quad(card.0, card.1, [0.1, 0.5, 0.3]);
    std::fs::write(file, mesh.glb(wall)).unwrap();
}

#[derive(Default)]
struct Mesh {
    positions: Vec<[f32; 3]>,
    colors: Vec<[f32; 4]>,
    indices: Vec<u32>,
}

impl Mesh {
    /// A rectangle that faces +Z, from its lower left corner.
    fn quad(&mut self, [x, y, z]: [f32; 3], [width, height]: [f32; 2], [r, g, b]: [f32; 3]) {
        let first = self.positions.len() as u32;
        for (dx, dy) in [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)] {
            self.positions.push([x + dx, y + dy, z]);
            self.colors.push([r, g, b, 1.0]);
        }
        self.indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
    }

    /// Two nodes: the first `wall` indices, and the rest.
    fn glb(&self, wall: usize) -> Vec<u8> {
        let mut binary: Vec<u8> = Vec::new();
        let mut views = Vec::new();
        let mut push = |bytes: Vec<u8>| {
            views.push(json!({"buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len()}));
            binary.extend(bytes);
        };
        push(self.positions.iter().flatten().flat_map(|v| v.to_le_bytes()).collect());
        push(self.colors.iter().flatten().flat_map(|v| v.to_le_bytes()).collect());
        push(self.indices.iter().flat_map(|v| v.to_le_bytes()).collect());
        let (vertices, card) = (self.positions.len(), self.indices.len() - wall);
        let primitive = |indices: u32, material: u32| json!({"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": indices, "material": material}]});
        let material = |name: &str| json!({"name": name, "extensions": {"KHR_materials_unlit": {}}});
        let document = json!({
            "asset": {"version": "2.0"},
            "extensionsUsed": ["KHR_materials_unlit"],
            "scene": 0,
            "scenes": [{"nodes": [0, 1, 2]}],
            "nodes": [{"name": "wall", "mesh": 0}, {"name": "card", "mesh": 1}, {"name": "shot", "camera": 0}],
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "aspectRatio": 1.5, "znear": 0.1}}],
            "materials": [material("chequered"), material("green")],
            "meshes": [primitive(2, 0), primitive(3, 1)],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": vertices, "type": "VEC3",
                 "min": [-3.0, -3.0, -5.0], "max": [3.0, 3.0, -2.0]},
                {"bufferView": 1, "componentType": 5126, "count": vertices, "type": "VEC4"},
                {"bufferView": 2, "componentType": 5125, "count": wall, "type": "SCALAR"},
                {"bufferView": 2, "byteOffset": wall * 4, "componentType": 5125, "count": card, "type": "SCALAR"}
            ],
            "bufferViews": views,
            "buffers": [{"byteLength": binary.len()}]
        });
        container(&document, binary)
    }
}

/// The two chunks of a GLB.
fn container(document: &Value, mut binary: Vec<u8>) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let total = 12 + 8 + text.len() + 8 + binary.len();
    let mut glb = Vec::with_capacity(total);
    glb.extend(b"glTF");
    glb.extend(2u32.to_le_bytes());
    glb.extend((total as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &binary)] {
        glb.extend((chunk.len() as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(chunk);
    }
    glb
}
