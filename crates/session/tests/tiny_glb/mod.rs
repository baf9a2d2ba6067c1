//! A small scene written by hand: unlit quads that face a camera named "front" at the origin, looking down −Z.

use serde_json::{Value, json};
use std::path::Path;

/// A quad at depth z, facing the camera.
#[derive(Clone, Copy)]
pub struct Quad {
    /// Name of its node; its material is this with " paint" after it.
    pub name: &'static str,
    /// Centre in x and y.
    pub center: [f32; 2],
    /// Half its sides.
    pub half: [f32; 2],
    /// Distance from the camera.
    pub depth: f32,
    /// Linear radiance.
    pub color: [f32; 3],
}

/// A grey wall at 4 with a red card before its left half at 2 and a bright dot at its right.
pub const QUADS: [Quad; 3] = [
    Quad { name: "wall", center: [0.0, 0.0], half: [4.0, 3.0], depth: 4.0, color: [0.3, 0.35, 0.4] },
    Quad { name: "card", center: [-0.4, 0.0], half: [0.3, 0.4], depth: 2.0, color: [0.8, 0.1, 0.1] },
    Quad { name: "dot", center: [0.8, 0.2], half: [0.05, 0.05], depth: 3.9, color: [1.0, 1.0, 0.6] },
];

/// The bytes of a GLB with these quads.
pub fn glb(quads: &[Quad]) -> Vec<u8> {
    let mut bin: Vec<u8> = Vec::new();
    let mut doc = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{ "nodes": [] }],
        "nodes": [], "meshes": [], "materials": [], "accessors": [], "bufferViews": [],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.6, "znear": 0.1, "aspectRatio": 1.5 } }],
    });
    let push = |doc: &mut Value, list: &str, value: Value| -> usize {
        let list = doc[list].as_array_mut().expect("a list");
        list.push(value);
        list.len() - 1
    };
    for quad in quads {
        let ([x, y], [w, h], z) = (quad.center, quad.half, -quad.depth);
        let positions = [[x - w, y - h, z], [x + w, y - h, z], [x + w, y + h, z], [x - w, y + h, z]];
        let uv = [[0.0f32, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
        let start = bin.len();
        bin.extend(positions.iter().flatten().flat_map(|c| c.to_le_bytes()));
        bin.extend(uv.iter().flatten().flat_map(|c| c.to_le_bytes()));
        bin.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
        let mut attribute = |offset: usize, bytes: usize, mut accessor: Value| {
            let view = json!({ "buffer": 0, "byteOffset": start + offset, "byteLength": bytes });
            accessor["bufferView"] = push(&mut doc, "bufferViews", view).into();
            push(&mut doc, "accessors", accessor)
        };
        let low = [x - w, y - h, z];
        let high = [x + w, y + h, z];
        let position = attribute(
            0,
            48,
            json!({ "componentType": 5126, "count": 4, "type": "VEC3", "min": low, "max": high }),
        );
        let texcoord = attribute(48, 32, json!({ "componentType": 5126, "count": 4, "type": "VEC2" }));
        let indices = attribute(80, 12, json!({ "componentType": 5123, "count": 6, "type": "SCALAR" }));
        let [r, g, b] = quad.color;
        let material = json!({
            "name": format!("{} paint", quad.name),
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0] },
            "extensions": { "KHR_materials_unlit": {} },
        });
        let material = push(&mut doc, "materials", material);
        let primitive = json!({
            "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "indices": indices, "material": material,
        });
        let mesh = push(&mut doc, "meshes", json!({ "primitives": [primitive] }));
        let node = push(&mut doc, "nodes", json!({ "name": quad.name, "mesh": mesh }));
        doc["scenes"][0]["nodes"].as_array_mut().expect("a list").push(node.into());
    }
    let camera = push(&mut doc, "nodes", json!({ "name": "front", "camera": 0 }));
    doc["scenes"][0]["nodes"].as_array_mut().expect("a list").push(camera.into());
    if !bin.is_empty() {
        doc["buffers"] = json!([{ "byteLength": bin.len() }]);
    }
    for list in ["meshes", "materials", "accessors", "bufferViews"] {
        if doc[list].as_array().is_some_and(Vec::is_empty) {
            doc.as_object_mut().expect("an object").remove(list);
        }
    }
    container(&doc, &bin)
}

/// The bytes of a GLB with these quads, the first of which are wall and card, in variants: in "Blue" the card is blue and the wall light, in "Green" the card is green; in "As painted"
/// all is as it was.
#[allow(dead_code, reason = "not every test that has the scene has its variants")]
pub fn varied(quads: &[Quad]) -> Vec<u8> {
    let (mut doc, bin) = parts(&glb(quads));
    let first = doc["materials"].as_array().expect("a list").len();
    for (name, color) in
        [("blue", [0.1, 0.1, 0.8, 1.0]), ("light", [0.9, 0.9, 0.9, 1.0]), ("green", [0.1, 0.8, 0.1, 1.0])]
    {
        let material = json!({
            "name": format!("{name} paint"),
            "pbrMetallicRoughness": { "baseColorFactor": color },
            "extensions": { "KHR_materials_unlit": {} },
        });
        doc["materials"].as_array_mut().expect("a list").push(material);
    }
    let mappings = |mappings: Value| json!({ "KHR_materials_variants": { "mappings": mappings } });
    let [wall, card] = [0, 1].map(|mesh| format!("/meshes/{mesh}/primitives/0"));
    doc.pointer_mut(&wall).expect("the wall")["extensions"] =
        mappings(json!([{ "material": first + 1, "variants": [0] }]));
    doc.pointer_mut(&card).expect("the card")["extensions"] =
        mappings(json!([{ "material": first, "variants": [0] }, { "material": first + 2, "variants": [1] }]));
    doc["extensions"] = json!({ "KHR_materials_variants": { "variants": [
        { "name": "Blue" }, { "name": "Green" }, { "name": "As painted" }] } });
    doc["extensionsUsed"] = json!(["KHR_materials_unlit", "KHR_materials_variants"]);
    container(&doc, &bin)
}

/// PNGs of one texel: red, cyan, white, yellow, green, blue.
#[allow(dead_code, reason = "not every test that has the scene has it lit")]
const COLORS: [&str; 6] = [
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mP4z8AAAAMBAQD3A0FDAAAAAElFTkSuQmCC",
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mNg+P8fAAMBAf+I73F5AAAAAElFTkSuQmCC",
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mP4//8/AAX+Av4zEpUUAAAAAElFTkSuQmCC",
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mP4/58BAAT/Af9jgNErAAAAAElFTkSuQmCC",
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mNg+M8AAAICAQBF9FLUAAAAAElFTkSuQmCC",
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mNgYPgPAAEDAQA2dBFAAAAAAElFTkSuQmCC",
];

/// The bytes of a GLB with these quads in an image-based light, "six colours": red from +X, cyan from −X, white from above, yellow from
/// below, green from +Z, which is behind the camera, and blue from −Z, twice as bright.
#[allow(dead_code, reason = "not every test that has the scene has it lit")]
pub fn lit(quads: &[Quad]) -> Vec<u8> {
    const EXTENSION: &str = "EXT_lights_image_based";
    let (mut doc, bin) = parts(&glb(quads));
    doc["extensionsUsed"] = json!(["KHR_materials_unlit", EXTENSION]);
    let images = COLORS.map(|png| json!({ "uri": format!("data:image/png;base64,{png}") }));
    doc["images"] = json!(images);
    doc["scenes"][0]["extensions"] = json!({ EXTENSION: { "light": 0 } });
    let light = json!({
        "name": "six colours", "intensity": 2.0, "specularImageSize": 1, "specularImages": [[0, 1, 2, 3, 4, 5]],
        "irradianceCoefficients": vec![[0.0; 3]; 9],
    });
    doc["extensions"] = json!({ EXTENSION: { "lights": [light] } });
    container(&doc, &bin)
}

/// The bytes of a GLB with these quads of rough metal, which no light of their own shines on: the studio does.
#[allow(dead_code, reason = "not every test that has the scene has it of metal")]
pub fn metal(quads: &[Quad]) -> Vec<u8> {
    let (mut doc, bin) = parts(&glb(quads));
    for material in doc["materials"].as_array_mut().expect("a list") {
        material["pbrMetallicRoughness"]["roughnessFactor"] = json!(0.4);
        material.as_object_mut().expect("an object").remove("extensions");
    }
    container(&doc, &bin)
}

/// The bytes of a GLB with these quads, the first of which are wall, card and dot, in motion ("slide", 1 s): the card goes right by 0.5 and turns about its
/// own axis, the dot is hidden from half a second on, the camera comes nearer by 0.5. Another animation, "stay", moves nothing.
#[allow(dead_code, reason = "not every test that has the scene has it in motion")]
pub fn moving(quads: &[Quad]) -> Vec<u8> {
    let (mut doc, mut bin) = parts(&glb(quads));
    let mut floats = |values: &[f32], shape: &str| {
        bin.resize(bin.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": 4 * values.len() });
        bin.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        let views = doc["bufferViews"].as_array_mut().expect("a list");
        views.push(view);
        let count = values.len()
            / match shape {
                "SCALAR" => 1,
                "VEC3" => 3,
                _ => 4,
            };
        let accessor =
            json!({ "bufferView": views.len() - 1, "componentType": 5126, "count": count, "type": shape });
        let accessors = doc["accessors"].as_array_mut().expect("a list");
        accessors.push(accessor);
        accessors.len() - 1
    };
    let second = floats(&[0.0, 1.0], "SCALAR");
    let halves = floats(&[0.0, 0.5], "SCALAR");
    let right = floats(&[0.0, 0.0, 0.0, 0.5, 0.0, 0.0], "VEC3");
    let turned = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.05, 1.0], "VEC4");
    let nearer = floats(&[0.0, 0.0, 0.0, 0.0, 0.0, -0.5], "VEC3");
    let hidden = floats(&[1.0, 0.0], "SCALAR");
    let camera = doc["nodes"].as_array().expect("a list").len() - 1;
    let pointer =
        json!({ "KHR_animation_pointer": { "pointer": "/nodes/2/extensions/KHR_node_visibility/visible" } });
    doc["animations"] = json!([
        { "name": "slide",
          "samplers": [
            { "input": second, "output": right }, { "input": second, "output": turned },
            { "input": second, "output": nearer }, { "input": halves, "output": hidden, "interpolation": "STEP" }],
          "channels": [
            { "sampler": 0, "target": { "node": 1, "path": "translation" } },
            { "sampler": 1, "target": { "node": 1, "path": "rotation" } },
            { "sampler": 2, "target": { "node": camera, "path": "translation" } },
            { "sampler": 3, "target": { "path": "pointer", "extensions": pointer } }] },
        { "name": "stay", "samplers": [{ "input": second, "output": second }], "channels": [] }]);
    doc["extensionsUsed"] = json!(["KHR_materials_unlit", "KHR_animation_pointer", "KHR_node_visibility"]);
    doc["buffers"] = json!([{ "byteLength": bin.len() }]);
    container(&doc, &bin)
}

/// The document and the buffer of a GLB.
#[allow(dead_code, reason = "not every test changes the scene")]
pub fn parts(bytes: &[u8]) -> (Value, Vec<u8>) {
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let end = 20 + length;
    (serde_json::from_slice(&bytes[20..end]).expect("JSON"), bytes[end + 8..].to_vec())
}

/// A GLB of a document and its buffer.
pub fn container(doc: &Value, bin: &[u8]) -> Vec<u8> {
    let mut text = serde_json::to_vec(doc).expect("JSON");
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bin = bin.to_vec();
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut out = Vec::new();
    let total = 12 + 8 + text.len() + if bin.is_empty() { 0 } else { 8 + bin.len() };
    out.extend(b"glTF");
    out.extend(2u32.to_le_bytes());
    out.extend((total as u32).to_le_bytes());
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(text);
    if !bin.is_empty() {
        out.extend((bin.len() as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(bin);
    }
    out
}

/// Writes the usual scene to `path`.
pub fn write(path: &Path) {
    std::fs::write(path, glb(&QUADS)).expect("the test's folder can be written");
}
