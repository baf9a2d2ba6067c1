//! Scenes that claim huge meshes and textures.

use super::super::harness::made_files::{
    glb, glb_of, png_of_zeros, put, quad_bytes, scene, scene_with_texture,
};
use super::bomb::{Bomb, bomb};
use serde_json::{Value, json};
use std::path::Path;

const INFO: &str = "info s.glb";
/// Near the largest count that a JSON reader takes.
const HUGE: u64 = 1 << 31;

/// Bombs in glTF.
pub const BOMBS: &[Bomb] = &[
    bomb("an accessor of 2³¹ zeros", INFO, |to| {
        changed(to, |scene| {
            scene["accessors"][0] = json!({"componentType": 5126, "count": HUGE, "type": "VEC3"});
        })
    }),
    bomb("a sparse accessor of 2³¹ values", INFO, |to| {
        changed(to, |scene| {
            scene["accessors"][0] = json!({"componentType": 5126, "count": HUGE, "type": "VEC3",
            "sparse": {"count": 1, "indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 0}}});
        })
    }),
    bomb("a sparse accessor with 2³¹ replacements", INFO, |to| {
        changed(to, |scene| {
            scene["accessors"][0]["sparse"] = json!({"count": HUGE,
            "indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 0}});
        })
    }),
    bomb("indices without data, 2³¹ of them", INFO, |to| {
        changed(to, |scene| {
            scene["accessors"][2] = json!({"componentType": 5125, "count": HUGE, "type": "SCALAR"});
        })
    }),
    bomb("a buffer of 2⁵⁰ bytes", INFO, |to| {
        changed(to, |scene| {
            scene["buffers"][0]["byteLength"] = json!(1u64 << 50);
            scene["bufferViews"][0]["byteLength"] = json!(1u64 << 49);
        })
    }),
    bomb("JSON 200,000 deep", INFO, |to| {
        put(to, "s.glb", glb(&format!("{{\"asset\":{}1{}}}", "[".repeat(200_000), "]".repeat(200_000)), b""))
    }),
    bomb("two billion instances", INFO, |to| {
        changed(to, |scene| {
            scene["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing", "KHR_materials_unlit"]);
            scene["accessors"][3] = json!({"componentType": 5126, "count": HUGE, "type": "VEC3"});
            scene["nodes"][0]["extensions"] =
                json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 3}}});
        })
    }),
    bomb("a morph target of 2³¹ zeros", INFO, |to| {
        changed(to, |scene| {
            scene["accessors"][3] = json!({"componentType": 5126, "count": HUGE, "type": "VEC3"});
            scene["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 3}]);
            scene["meshes"][0]["weights"] = json!([1.0]);
        })
    }),
    bomb(
        "an animation of 2³¹ keys",
        "render s.glb --frames 1-2 --size 8x8 --backend cpu -o o.####.png",
        |to| {
            changed(to, |scene| {
                scene["accessors"][3] =
                    json!({"componentType": 5126, "count": HUGE, "type": "SCALAR", "min": [0], "max": [1]});
                scene["accessors"][4] = json!({"componentType": 5126, "count": HUGE, "type": "VEC3"});
                scene["animations"] = json!([{"samplers": [{"input": 3, "output": 4}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]);
            })
        },
    ),
    bomb("a meshopt view of 2³¹ vertices", INFO, |to| {
        changed(to, |scene| {
            scene["extensionsUsed"] = json!(["EXT_meshopt_compression"]);
            scene["accessors"][0]["count"] = json!(HUGE);
            scene["bufferViews"][0] = json!({"buffer": 0, "byteLength": HUGE * 12, "byteStride": 12, "extensions":
            {"EXT_meshopt_compression": {"buffer": 0, "byteLength": 48, "byteStride": 12, "count": HUGE, "mode": "ATTRIBUTES"}}});
        })
    }),
    bomb("a Draco mesh of 2³² − 1 faces", INFO, |to| {
        let mut buffer = b"DRACO\x02\x02\x01\x01\0\0".to_vec();
        // Faces, points: variable-length numbers.
        buffer.extend([0xff, 0xff, 0xff, 0xff, 0x0f, 0xff, 0xff, 0xff, 0xff, 0x0f]);
        buffer.resize(92, 0);
        let mut scene = scene();
        scene["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
        scene["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
        for accessor in 0..3 {
            scene["accessors"][accessor]["bufferView"].take();
            scene["accessors"][accessor]["count"] = json!(u32::MAX);
        }
        scene["accessors"] = without_nulls(&scene["accessors"]);
        scene["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_draco_mesh_compression":
            {"bufferView": 0, "attributes": {"POSITION": 0, "TEXCOORD_0": 1}}});
        scene["bufferViews"][0]["byteLength"] = json!(92);
        put(to, "s.glb", glb(&scene.to_string(), &buffer))
    }),
    bomb("a KTX2 texture of 65,536 × 65,536", INFO, |to| ktx2(to, 65_536, 1, BASIS_LZ)),
    bomb("a KTX2 texture with 2³² − 1 levels", INFO, |to| ktx2(to, 64, u32::MAX, BASIS_LZ)),
    bomb("a KTX2 level of 64 × 64 that claims to inflate to 16 EB", INFO, |to| ktx2(to, 64, 1, ZSTANDARD)),
    bomb(
        "a PNG texture that really inflates to 900 MB",
        "render s.gltf --size 8x8 --backend cpu -o o.png",
        |to| {
            put(to, "t.png", png_of_zeros([30_000; 2], 0, b"", 30_000 * 30_001))?;
            let mut scene = scene_with_texture("t.png", None);
            scene["buffers"][0]["uri"] = json!("quad.bin");
            put(to, "quad.bin", quad_bytes())?;
            put(to, "s.gltf", scene.to_string())
        },
    ),
];

fn changed(to: &Path, change: impl Fn(&mut Value)) -> Result<(), String> {
    let mut scene = scene();
    let accessors = scene["accessors"].as_array_mut().ok_or("no accessors")?;
    accessors.extend([accessors[0].clone(), accessors[0].clone()]);
    change(&mut scene);
    // Counts that differ from each other would be noticed first.
    if let Some(attributes) = scene["meshes"][0]["primitives"][0]["attributes"].as_object_mut() {
        attributes.remove("TEXCOORD_0");
    }
    put(to, "s.glb", glb_of(&scene))
}

fn without_nulls(values: &Value) -> Value {
    let clean = |value: &Value| {
        let mut value = value.clone();
        if let Some(object) = value.as_object_mut() {
            object.retain(|_, field| !field.is_null());
        }
        value
    };
    Value::Array(values.as_array().map(|all| all.iter().map(clean).collect()).unwrap_or_default())
}

/// Supercompression of KTX 2.
const BASIS_LZ: u32 = 1;
const ZSTANDARD: u32 = 2;

fn ktx2(to: &Path, side: u32, levels: u32, scheme: u32) -> Result<(), String> {
    let mut file = b"\xabKTX 20\xbb\r\n\x1a\n".to_vec();
    // Format (0: Basis Universal), type size, width, height, depth, layers, faces, levels, supercompression.
    file.extend([0, 1, side, side, 0, 0, 1, levels, scheme].into_iter().flat_map(u32::to_le_bytes));
    file.extend([0; 32]);
    file.extend([u64::from(u32::MAX), 64, u64::MAX >> 4].into_iter().flat_map(u64::to_le_bytes));
    file.extend([0; 128]);
    put(to, "t.ktx2", file)?;
    let mut scene = scene_with_texture("t.ktx2", Some("image/ktx2"));
    scene["extensionsUsed"] = json!(["KHR_texture_basisu", "KHR_materials_unlit"]);
    scene["textures"] = json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]);
    put(to, "s.glb", glb_of(&scene))
}
