//! Small files, built here: a triangle to begin with, changed by each test as it needs.

#![allow(dead_code, reason = "each file of tests needs a part of it")]

use progress::Unwatched;
use scene::{LoadOptions, Scene, SceneError, SurfacePoint, load};
use serde_json::{Value, json};
use tempfile::TempDir;

/// A document and its binary chunk.
pub struct Glb {
    pub json: Value,
    pub bin: Vec<u8>,
}

impl Glb {
    /// One right-angled triangle (0,0,0), (1,0,0), (0,1,0), normals up z, on a node called "tri".
    pub fn triangle() -> Self {
        let mut glb = Self {
            json: json!({
                "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
                "nodes": [{"name": "tri", "mesh": 0}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}}]}],
                "buffers": [{"byteLength": 0}], "bufferViews": [], "accessors": []
            }),
            bin: Vec::new(),
        };
        glb.accessor(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0f32], "VEC3");
        glb.json["accessors"][0]["min"] = json!([0, 0, 0]);
        glb.json["accessors"][0]["max"] = json!([1, 1, 0]);
        glb.accessor(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0f32], "VEC3");
        glb
    }

    /// Appends an accessor of floats; returns its index.
    pub fn accessor(&mut self, values: &[f32], shape: &str) -> usize {
        let components = match shape {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.raw_accessor(&bytes, 5126, shape, values.len() / components)
    }

    /// The same of any component type.
    pub fn raw_accessor(&mut self, bytes: &[u8], component: u32, shape: &str, count: usize) -> usize {
        let view = json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()});
        self.bin.extend_from_slice(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.json["buffers"][0]["byteLength"] = json!(self.bin.len());
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(view);
        let accessor =
            json!({"bufferView": views.len() - 1, "componentType": component, "type": shape, "count": count});
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors.push(accessor);
        accessors.len() - 1
    }

    /// The file.
    pub fn bytes(&self) -> Vec<u8> {
        let mut json = self.json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let word = |n: usize| (n as u32).to_le_bytes();
        let mut bytes = [b"glTF".to_vec(), word(2).to_vec()].concat();
        bytes.extend(word(28 + json.len() + self.bin.len()));
        bytes.extend(word(json.len()).iter().chain(b"JSON").chain(&json));
        bytes.extend(word(self.bin.len()).iter().chain(b"BIN\0").chain(&self.bin));
        bytes
    }

    /// The scene or what is wrong.
    pub fn load(&self) -> Result<Scene, SceneError> {
        load_bytes(&self.bytes(), &LoadOptions::default())
    }

    /// The scene, if nothing at all is wrong with the file.
    pub fn clean(&self) -> Scene {
        let scene = self.load().unwrap();
        assert_eq!(scene.warnings, [""; 0]);
        scene
    }

    /// What is wrong with the file.
    pub fn error(&self) -> String {
        self.load().unwrap_err().to_string()
    }
}

/// Loads a file of these bytes.
pub fn load_bytes(bytes: &[u8], options: &LoadOptions) -> Result<Scene, SceneError> {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("handmade.glb");
    std::fs::write(&file, bytes).unwrap();
    load(&file, options, &Unwatched)
}

/// A point in the middle of the first triangle.
pub const MIDDLE: SurfacePoint = SurfacePoint { triangle: 0, barycentric: glam::DVec2::new(0.25, 0.25) };
