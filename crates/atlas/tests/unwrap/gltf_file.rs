//! A glTF file made of code, with something of everything that a file may have.

use crate::meshes::{bare, sphere};
use glam::DVec3;
use serde_json::{Value, json};

/// A document and its buffer.
pub struct GltfFile {
    pub document: Value,
    pub buffer: Vec<u8>,
}

/// glTF's numbers of component types.
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_SHORT: u32 = 5123;
const FLOAT: u32 = 5126;

/// A picture of one texel.
pub const PNG: &str =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";

impl GltfFile {
    pub fn new() -> Self {
        let document = json!({ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [] }] });
        Self { document, buffer: Vec::new() }
    }

    /// Appends to a top-level list; the index there.
    pub fn push(&mut self, key: &str, value: Value) -> usize {
        if self.document[key].is_null() {
            self.document[key] = json!([]);
        }
        let list = self.document[key].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    fn view(&mut self, bytes: &[u8], mut view: Value) -> usize {
        view["buffer"] = json!(0);
        view["byteOffset"] = json!(self.buffer.len());
        view["byteLength"] = json!(bytes.len());
        self.buffer.extend(bytes);
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        self.push("bufferViews", view)
    }

    /// An accessor of elements of `size` bytes, each padded to four.
    fn elements(&mut self, bytes: &[u8], size: usize, mut accessor: Value) -> usize {
        let stride = size.next_multiple_of(4);
        let padded: Vec<u8> = bytes
            .chunks_exact(size)
            .flat_map(|element| element.iter().copied().chain(std::iter::repeat_n(0, stride - size)))
            .collect();
        let target = if stride == size { json!({}) } else { json!({ "byteStride": stride }) };
        accessor["bufferView"] = json!(self.view(&padded, target));
        accessor["count"] = json!(bytes.len() / size);
        self.push("accessors", accessor)
    }

    pub fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
        let kind = match N {
            1 => "SCALAR",
            16 => "MAT4",
            _ => ["VEC2", "VEC3", "VEC4"][N - 2],
        };
        self.elements(&bytes, 4 * N, json!({ "componentType": FLOAT, "type": kind }))
    }

    pub fn positions(&mut self, values: &[[f32; 3]]) -> usize {
        let accessor = self.floats(values);
        let fold =
            |of: fn(f32, f32) -> f32| values.iter().copied().reduce(|a, b| [0, 1, 2].map(|k| of(a[k], b[k])));
        self.document["accessors"][accessor]["min"] = json!(fold(f32::min).unwrap());
        self.document["accessors"][accessor]["max"] = json!(fold(f32::max).unwrap());
        accessor
    }

    pub fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|i| i.to_le_bytes()).collect();
        let view = self.view(&bytes, json!({}));
        let count = values.len();
        let accessor =
            json!({ "bufferView": view, "componentType": UNSIGNED_SHORT, "type": "SCALAR", "count": count });
        self.push("accessors", accessor)
    }

    /// Adds a node; a root unless it is somebody's child.
    pub fn node(&mut self, node: Value, is_root: bool) -> usize {
        let index = self.push("nodes", node);
        if is_root {
            self.document["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(index));
        }
        index
    }

    /// The bytes as GLB.
    pub fn glb(&self) -> Vec<u8> {
        let mut document = self.document.clone();
        document["buffers"] = json!([{ "byteLength": self.buffer.len(), "extras": "kept" }]);
        crate::tiny_glb::container(&document, &self.buffer)
    }
}

/// A mesh of a ball that has seams wherever it is laid out, with every kind of attribute.
fn ball(file: &mut GltfFile, material: usize) -> usize {
    let piece = bare(sphere(5, 0.5, DVec3::ZERO));
    let count = piece.positions.len();
    let positions: Vec<[f32; 3]> = piece.positions.iter().map(|p| p.as_vec3().to_array()).collect();
    let normals: Vec<[f32; 3]> = piece.positions.iter().map(|p| p.normalize().as_vec3().to_array()).collect();
    let corners: Vec<u16> = piece.triangles.iter().flatten().map(|&v| v as u16).collect();
    let weights: Vec<[f32; 4]> =
        (0..count).map(|v| [v as f32 / count as f32, 1.0 - v as f32 / count as f32, 0.0, 0.0]).collect();
    let joints: Vec<u8> = (0..count).flat_map(|_| [0, 1, 0, 0]).collect();
    let colors: Vec<u8> = (0..count).flat_map(|v| [v as u8 * 5, 200, 100]).collect();
    let heat: Vec<u8> = (0..count as u16).flat_map(|v| (1000 + 3 * v).to_le_bytes()).collect();
    let attributes = json!({
        "POSITION": file.positions(&positions),
        "NORMAL": file.floats(&normals),
        "WEIGHTS_0": file.floats(&weights),
        "JOINTS_0": file.elements(&joints, 4, json!({ "componentType": UNSIGNED_BYTE, "type": "VEC4" })),
        "COLOR_0": file.elements(&colors, 3, json!({ "componentType": UNSIGNED_BYTE, "type": "VEC3", "normalized": true })),
        "_HEAT": file.elements(&heat, 2, json!({ "componentType": UNSIGNED_SHORT, "type": "SCALAR", "name": "heat",
            "extras": { "unit": "K" }, "min": [1000], "max": [1000 + 3 * (count - 1)] })),
    });
    // Only a few vertices move: a sparse accessor without anything else.
    let moved = [1u16, 7, 20];
    let bytes: Vec<u8> = moved.iter().flat_map(|i| i.to_le_bytes()).collect();
    let places = file.view(&bytes, json!({}));
    let bytes: Vec<u8> = [[0.25f32, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, -0.125]]
        .as_flattened()
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let deltas = file.view(&bytes, json!({}));
    let delta = file.push("accessors", json!({
        "componentType": FLOAT, "type": "VEC3", "count": count, "min": [0, 0, -0.125], "max": [0.25, 0.5, 0],
        "sparse": { "count": 3, "indices": { "bufferView": places, "componentType": UNSIGNED_SHORT },
                    "values": { "bufferView": deltas } },
    }));
    let indices = file.indices(&corners);
    file.push("meshes", json!({
        "name": "ball", "weights": [0.5], "extras": { "targetNames": ["bump"] },
        "primitives": [{ "attributes": attributes, "indices": indices, "material": material,
            "targets": [{ "POSITION": delta }], "extras": [1, { "deep": 0.1 }], "extensions": { "ACME_paint": { "coats": 2 } } }],
    }))
}

/// A file with hierarchy, instances, skins, morph targets, animations, cameras, lights, extensions and extras.
pub fn rich() -> GltfFile {
    let mut file = GltfFile::new();
    let image = file.push("images", json!({ "uri": format!("data:image/png;base64,{PNG}"), "name": "dot" }));
    let texture = file.push("textures", json!({ "source": image, "extras": 7 }));
    let plain =
        file.push("materials", json!({ "name": "plain", "extensions": { "ACME_paint": { "gloss": 0.3 } } }));
    let worn = file.push(
        "materials",
        json!({
            "name": "worn", "pbrMetallicRoughness": { "baseColorTexture": { "index": texture } },
            "occlusionTexture": { "index": texture, "texCoord": 1 },
        }),
    );
    let ball = ball(&mut file, plain);

    let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.25]];
    let uv = corners.map(|[x, y, _]| [x, y]);
    let strip_uv = [uv, uv.map(|[u, v]| [3.0 * u, -v])].map(|uv| file.floats(&uv));
    let strip_positions = file.positions(&corners);
    let dots = file.positions(&[[5.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
    let strip = file.push("meshes", json!({ "name": "strip", "primitives": [
        { "attributes": { "POSITION": dots }, "mode": 0, "extras": "points" },
        { "attributes": { "POSITION": strip_positions, "TEXCOORD_0": strip_uv[0], "TEXCOORD_1": strip_uv[1] },
          "mode": 5, "material": worn },
    ]}));
    let leaf_positions = file.positions(&[[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.3, 0.1]]);
    let leaf = file.push(
        "meshes",
        json!({ "name": "leaf", "primitives": [{ "attributes": { "POSITION": leaf_positions } }] }),
    );

    let joints = [0.0, 1.0].map(|x| {
        let joint = json!({ "name": format!("joint {x}"), "translation": [x, 0.25, 0.1] });
        file.node(joint, true)
    });
    let mut identity = [0.0f32; 16];
    [0, 5, 10, 15].iter().for_each(|&k| identity[k] = 1.0);
    let binds = file.floats(&[identity, identity]);
    let skin = file.push("skins", json!({ "joints": joints, "inverseBindMatrices": binds, "name": "bones" }));
    file.node(json!({ "name": "skinned", "mesh": ball, "skin": skin, "weights": [0.25] }), true);
    let inner = file.node(json!({ "name": "ball in the tree", "mesh": ball, "scale": [0.5, 0.7, 0.5], "extras": { "id": 0.30000000000000004 } }), false);
    let strip_node = file.node(json!({ "name": "strip", "mesh": strip, "scale": [-1.0, 1.0, 1.0] }), false);
    file.node(
        json!({ "name": "root", "translation": [0.1, 2.0, -3.0], "rotation": [0.0, 0.6, 0.0, 0.8],
        "children": [inner, strip_node], "extensions": { "ACME_paint": [1, 2] } }),
        true,
    );

    let camera = file.push(
        "cameras",
        json!({ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.01 }, "name": "eye" }),
    );
    let camera =
        file.node(json!({ "name": "camera", "camera": camera, "translation": [0.0, 0.0, 9.0] }), false);
    let places = file.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.5]]);
    let sizes = file.floats(&[[1.0, 1.0, 1.0], [2.0, 2.0, 2.0], [1.0, 3.0, 1.0]]);
    file.node(json!({ "name": "grove", "mesh": leaf, "translation": [-2.0, 0.0, 0.0], "children": [camera],
        "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": places, "SCALE": sizes } } } }), true);
    file.node(
        json!({ "name": "lamp", "translation": [0.0, 4.0, 0.0],
        "extensions": { "KHR_lights_punctual": { "light": 0 } } }),
        true,
    );

    let times = file.floats(&[[0.0], [1.0]]);
    let turns = file.floats(&[[0.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0]]);
    file.document["accessors"][times]["min"] = json!([0]);
    file.document["accessors"][times]["max"] = json!([1]);
    file.push(
        "animations",
        json!({ "name": "turn", "samplers": [{ "input": times, "output": turns }],
        "channels": [{ "sampler": 0, "target": { "node": inner, "path": "rotation" } }] }),
    );
    file.document["extensionsUsed"] = json!(["ACME_paint", "EXT_mesh_gpu_instancing", "KHR_lights_punctual"]);
    file.document["extensions"] = json!({ "ACME_paint": { "tins": [0.1, 1e-7, 12345678901234u64] },
        "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 3.0, "name": "bulb" }] } });
    file.document["extras"] = json!({ "made by": "hand", "empty": [] });
    file
}
