//! Every value of a document that uses everything, replaced by every kind of nonsense: an error or a warning at the
//! place, never a panic.

use progress::Unwatched;
use scene::{LoadOptions, load};
use serde_json::{Value, json};
use tempfile::TempDir;

/// A document that uses every property that is read, its data in one buffer.
fn document() -> Value {
    let uri = format!("data:;base64,{}", "A".repeat(512));
    json!({
        "asset": {"version": "2.0", "generator": "hand"},
        "extensionsUsed": ["KHR_lights_punctual", "EXT_texture_webp", "KHR_node_visibility"], "extensionsRequired": [],
        "scene": 0, "scenes": [{"nodes": [0, 2]}],
        "nodes": [
            {"name": "root", "children": [1], "translation": [1, 2, 3], "rotation": [0, 0, 0, 1],
             "scale": [1, 1, 1], "camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"mesh": 0, "skin": 0, "weights": [0.5]},
            {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
             "extensions": {"KHR_node_visibility": {"visible": true},
                "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0, "ROTATION": 3}}}}
        ],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1, "aspectRatio": 1.5}},
            {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 1}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "color": [1, 1, 1], "intensity": 2,
            "range": 5, "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.2}}]}},
        "skins": [{"joints": [0, 1], "inverseBindMatrices": 4, "skeleton": 0}],
        "meshes": [{"weights": [0.1], "primitives": [{
            "attributes": {"POSITION": 0, "NORMAL": 0, "TEXCOORD_0": 1, "COLOR_0": 3, "JOINTS_0": 5, "WEIGHTS_0": 3},
            "indices": 2, "material": 0, "mode": 4,
            "targets": [{"POSITION": 0, "NORMAL": 0, "TEXCOORD_0": 1, "COLOR_0": 3}]},
            {"attributes": {"POSITION": 0, "TEXCOORD_2": 1}, "material": 1}]}],
        "materials": [{"name": "paint", "alphaMode": "MASK", "alphaCutoff": 0.1, "doubleSided": true,
            "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0, "roughnessFactor": 1,
                "baseColorTexture": {"index": 0, "texCoord": 0, "extensions":
                    {"KHR_texture_transform": {"offset": [0, 0], "rotation": 1, "scale": [1, 1], "texCoord": 0}}}},
            "normalTexture": {"index": 0, "scale": 1}, "occlusionTexture": {"index": 0, "strength": 1},
            "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 1},
            "extensions": {"KHR_materials_unlit": {}, "KHR_materials_specular": {"specularFactor": 0.5},
                "KHR_materials_emissive_strength": {"emissiveStrength": 2}}},
            {"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [1, 1, 1, 1],
                "diffuseTexture": {"index": 1, "texCoord": 2}, "specularFactor": [0, 0, 0], "glossinessFactor": 0,
                "specularGlossinessTexture": {"index": 0}}}}],
        "textures": [{"source": 0, "sampler": 0}, {"extensions": {"EXT_texture_webp": {"source": 1}}}],
        "samplers": [{"magFilter": 9728, "minFilter": 9729, "wrapS": 33071, "wrapT": 33648}],
        "images": [{"uri": "absent.png", "name": "a"}, {"bufferView": 0, "mimeType": "image/webp"}],
        "buffers": [{"byteLength": 384, "uri": uri}],
        "bufferViews": [{"buffer": 0, "byteLength": 384, "byteOffset": 0},
            {"buffer": 0, "byteLength": 96, "byteStride": 12, "target": 34962}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0], "max": [0, 0, 0]},
            {"bufferView": 1, "byteOffset": 4, "componentType": 5126, "type": "VEC2", "count": 3},
            {"bufferView": 0, "componentType": 5123, "type": "SCALAR", "count": 3, "sparse": {"count": 1,
                "indices": {"bufferView": 0, "byteOffset": 2, "componentType": 5121}, "values": {"bufferView": 0}}},
            {"bufferView": 0, "componentType": 5121, "normalized": true, "type": "VEC4", "count": 3},
            {"bufferView": 0, "componentType": 5126, "type": "MAT4", "count": 2},
            {"bufferView": 0, "componentType": 5121, "type": "VEC4", "count": 3}
        ],
        "animations": [{"samplers": [{"input": 2, "output": 0, "interpolation": "LINEAR"}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]
    })
}

/// JSON pointers to all values.
fn places(value: &Value, place: String, all: &mut Vec<String>) {
    match value {
        Value::Object(map) => {
            map.iter().for_each(|(key, value)| places(value, format!("{place}/{key}"), all))
        }
        Value::Array(list) => {
            // One number of a vector is as good as another.
            let different = if list.iter().all(Value::is_number) { 1 } else { list.len() };
            let items = list.iter().enumerate().take(different);
            items.for_each(|(i, value)| places(value, format!("{place}/{i}"), all));
        }
        _ => {}
    }
    all.push(place);
}

#[test]
fn no_wrong_value_panics() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("wrong.gltf");
    let outcome = |document: &Value| {
        std::fs::write(&file, document.to_string()).unwrap();
        match load(&file, &LoadOptions::default(), &Unwatched) {
            Ok(scene) => format!("opens, {:?}", scene.warnings),
            Err(error) => error.to_string(),
        }
    };
    let whole = document();
    assert!(outcome(&whole).starts_with("opens"), "{}", outcome(&whole));
    let mut all = Vec::new();
    places(&whole, String::new(), &mut all);
    assert!(all.len() > 200, "{}", all.len());
    let nonsense = [
        Value::Null,
        json!("nonsense"),
        json!(-1),
        json!(7),
        json!(4_294_967_296u64),
        json!(1e300),
        json!([]),
        json!({}),
        json!([null, {"a": [-1]}]),
    ];
    let (mut opened, mut silent) = (0, Vec::new());
    for place in &all {
        for value in &nonsense {
            let mut wrong = whole.clone();
            if let Some(spot) = wrong.pointer_mut(place) {
                *spot = value.clone();
            }
            let outcome = outcome(&wrong);
            assert!(!outcome.contains("the decoder failed"), "{place} = {value}: {outcome}");
            opened += u32::from(outcome.starts_with("opens"));
            // A word where a number or an object must be is always told: its place, or of a list the list's, or what
            // refers to the list that is none.
            let parent = place.rsplit_once('/').map_or("", |(parent, _)| parent);
            let told = outcome.contains(place.as_str())
                || !parent.is_empty() && outcome.contains(parent)
                || parent.is_empty() && outcome.contains("does not exist");
            if value == "nonsense" && !whole.pointer(place).is_some_and(Value::is_string) && !told {
                silent.push(format!("{place}: {outcome}"));
            }
        }
    }
    assert!(opened > 400, "{opened}");
    assert!(silent.is_empty(), "{}", silent.join("\n"));
}
