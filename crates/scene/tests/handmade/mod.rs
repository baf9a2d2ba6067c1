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

    /// A texture, whose index is returned: one row of texels.
    pub fn texture(&mut self, texels: &[[u8; 4]]) -> usize {
        let mut png = Vec::new();
        image::RgbaImage::from_vec(texels.len() as u32, 1, texels.as_flattened().to_vec())
            .unwrap()
            .write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png)
            .unwrap();
        let view = json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": png.len()});
        self.bin.extend(&png);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.json["buffers"][0]["byteLength"] = json!(self.bin.len());
        self.json["bufferViews"].as_array_mut().unwrap().push(view);
        let view = self.json["bufferViews"].as_array().unwrap().len() - 1;
        let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
        let (mut images, mut textures) = (list(&self.json["images"]), list(&self.json["textures"]));
        images.push(json!({"bufferView": view, "mimeType": "image/png"}));
        textures.push(json!({"source": images.len() - 1}));
        (self.json["images"], self.json["textures"]) = (json!(images), json!(textures));
        textures.len() - 1
    }

    /// Puts all corners of the triangle at one place of UV set `set`.
    pub fn put_uv(&mut self, set: u32, u: f32, v: f32) {
        let accessor = self.accessor(&[u, v].repeat(3), "VEC2");
        self.json["meshes"][0]["primitives"][0]["attributes"][format!("TEXCOORD_{set}")] = json!(accessor);
    }

    /// Gives the triangle a material, the only one.
    pub fn paint(&mut self, material: Value) {
        self.json["materials"] = json!([material]);
        self.json["meshes"][0]["primitives"][0]["material"] = json!(0);
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
