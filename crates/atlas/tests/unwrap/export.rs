//! The exported GLB: what was in the file stays, and the scene crate reads the same scene with the atlas.

use crate::Test;
use crate::data::{data_folder, gltf_files};
use crate::gltf_file::{GltfFile, PNG, rich};
use crate::layout::unwrap;
use atlas::{Atlas, AtlasError, UnwrapOptions, UvPolicy, glb_bytes, write_glb};
use glam::Vec2;
use progress::Unwatched;
use scene::{LoadOptions, Scene};
use serde_json::{Value, json};
use std::path::Path;

pub const TESTS: &[Test] = &[
    ("export::only_the_atlas_is_added", only_the_atlas_is_added),
    ("export::the_same_scene_reads_back", the_same_scene_reads_back),
    ("export::seams_take_all_attributes_along", seams_take_all_attributes_along),
    ("export::the_set_is_one_that_nobody_uses", the_set_is_one_that_nobody_uses),
    ("export::files_beside_come_along", files_beside_come_along),
    ("export::every_file_is_written_again", every_file_is_written_again),
    ("export::a_file_that_changed_is_refused", a_file_that_changed_is_refused),
    ("export::a_folder_that_is_not_there_is_named", a_folder_that_is_not_there_is_named),
];

/// An exported file.
struct Written {
    document: Value,
    chunk: Vec<u8>,
}

impl Written {
    fn of(bytes: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
        let text = word(12);
        assert_eq!((text % 4, &bytes[16..20]), (0, &b"JSON"[..]));
        let (length, chunk) = (word(20 + text), 28 + text);
        assert_eq!((&bytes[chunk - 4..chunk], chunk + length), (&b"BIN\0"[..], bytes.len()));
        let document = serde_json::from_slice(&bytes[20..20 + text]).unwrap();
        Self { document, chunk: bytes[chunk..].to_vec() }
    }

    fn at(&self, pointer: &str) -> &Value {
        self.document.pointer(pointer).unwrap_or_else(|| panic!("{pointer} in {:#}", self.document))
    }

    fn accessor(&self, index: &Value) -> &Value {
        &self.document["accessors"][index.as_u64().unwrap() as usize]
    }

    /// The elements of an accessor that is not sparse, as they are stored.
    fn elements(&self, index: &Value) -> Vec<&[u8]> {
        let accessor = self.accessor(index);
        let number = |value: &Value| value.as_u64().unwrap_or(0) as usize;
        let view = &self.document["bufferViews"][number(&accessor["bufferView"])];
        let (start, length) = (number(&view["byteOffset"]), number(&view["byteLength"]));
        let bytes = &self.chunk[start..start + length][number(&accessor["byteOffset"])..];
        let size = element_size(accessor);
        let stride = view["byteStride"].as_u64().map_or(size, |stride| stride as usize);
        (0..number(&accessor["count"])).map(|i| &bytes[i * stride..i * stride + size]).collect()
    }

    /// Everything that the format asks of accessors, views and buffers.
    fn check_structure(&self) {
        let list = |key: &str| self.document[key].as_array().cloned().unwrap_or_default();
        let number = |value: &Value| value.as_u64().unwrap_or(0) as usize;
        let buffers = list("buffers");
        assert!(self.chunk.len() - number(&buffers[0]["byteLength"]) < 4 && buffers[0].get("uri").is_none());
        for view in list("bufferViews").iter().filter(|view| view["buffer"] == 0) {
            assert!(number(&view["byteOffset"]) + number(&view["byteLength"]) <= self.chunk.len(), "{view}");
        }
        for (index, accessor) in list("accessors").iter().enumerate() {
            let Some(view) = accessor.get("bufferView") else { continue };
            let view = &list("bufferViews")[number(view)];
            let (size, count) = (element_size(accessor), number(&accessor["count"]));
            let stride = view["byteStride"].as_u64().map_or(size, |stride| stride as usize);
            let end = number(&accessor["byteOffset"]) + (count - 1) * stride + size;
            assert!(end <= number(&view["byteLength"]), "accessor {index}: {accessor} in {view}");
            let start = number(&accessor["byteOffset"]) + number(&view["byteOffset"]);
            assert_eq!(start % component_size(accessor), 0, "accessor {index}: {accessor} in {view}");
        }
        for primitive in primitives(&self.document) {
            let targets = primitive["targets"].as_array().into_iter().flatten();
            let count = number(&self.accessor(&primitive["attributes"]["POSITION"])["count"]);
            for attributes in std::iter::once(&primitive["attributes"]).chain(targets) {
                for (name, index) in attributes.as_object().unwrap() {
                    let accessor = self.accessor(index);
                    assert_eq!(number(&accessor["count"]), count, "{name}: {accessor}");
                    if name == "POSITION" && accessor.get("sparse").is_none() {
                        assert_eq!(
                            self.bounds(index),
                            [&accessor["min"], &accessor["max"]].map(floats),
                            "{accessor}"
                        );
                    }
                    if let Some(view) = accessor.get("bufferView") {
                        let view = &self.document["bufferViews"][number(view)];
                        let stride = view["byteStride"].as_u64().unwrap_or(element_size(accessor) as u64);
                        assert!(
                            stride.is_multiple_of(4) && view["target"] != 34963,
                            "{name}: {accessor} in {view}"
                        );
                    }
                }
            }
            if let Some(indices) = primitive.get("indices") {
                let largest = self.elements(indices).iter().map(|bytes| whole(bytes)).max().unwrap();
                assert!((largest as usize) < count, "{primitive}");
            }
        }
    }

    fn bounds(&self, index: &Value) -> [Vec<f64>; 2] {
        let kind = self.accessor(index)["componentType"].as_u64();
        let component = |bytes: &[u8]| match kind {
            Some(5120) => f64::from(bytes[0] as i8),
            Some(5122) => f64::from(whole(bytes) as i16),
            Some(5126) => f64::from(f32::from_bits(whole(bytes))),
            _ => f64::from(whole(bytes)),
        };
        let size = component_size(self.accessor(index));
        let values = self.elements(index).into_iter();
        let values = values.map(|bytes| bytes.chunks_exact(size).map(component).collect::<Vec<_>>());
        let values: Vec<_> = values.collect();
        let fold = |of: fn(f64, f64) -> f64| {
            let pick = |a: Vec<f64>, b: Vec<f64>| a.into_iter().zip(b).map(|(a, b)| of(a, b)).collect();
            values.iter().cloned().reduce(pick).unwrap()
        };
        [fold(f64::min), fold(f64::max)]
    }
}

fn floats(list: &Value) -> Vec<f64> {
    list.as_array().unwrap().iter().map(|x| f64::from(x.as_f64().unwrap() as f32)).collect()
}

fn whole(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |sum, byte| sum << 8 | u32::from(*byte))
}

fn component_size(accessor: &Value) -> usize {
    match accessor["componentType"].as_u64() {
        Some(5120 | 5121) => 1,
        Some(5122 | 5123) => 2,
        _ => 4,
    }
}

fn element_size(accessor: &Value) -> usize {
    let components = match accessor["type"].as_str().unwrap() {
        "SCALAR" => 1,
        "MAT4" => 16,
        vector => vector[3..].parse().unwrap(),
    };
    components * component_size(accessor)
}

fn primitives(document: &Value) -> impl Iterator<Item = &Value> {
    document["meshes"]
        .as_array()
        .into_iter()
        .flatten()
        .flat_map(|mesh| mesh["primitives"].as_array().unwrap())
}

fn load(path: &Path) -> Scene {
    scene::load(path, &LoadOptions::default(), &Unwatched).unwrap()
}

/// The rich file, its scene and atlas, and what is written of it.
fn export(file: &GltfFile) -> (Scene, Atlas, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rich.glb");
    std::fs::write(&path, file.glb()).unwrap();
    let scene = load(&path);
    let atlas = unwrap(&scene, &UnwrapOptions { uv: UvPolicy::Ignore, ..UnwrapOptions::default() });
    let bytes = glb_bytes(&scene, &atlas, &Unwatched).unwrap();
    assert_eq!(bytes, glb_bytes(&scene, &atlas, &Unwatched).unwrap(), "twice the same bytes");
    (scene, atlas, bytes)
}

fn only_the_atlas_is_added() {
    let file = rich();
    let (.., bytes) = export(&file);
    let written = Written::of(&bytes);
    written.check_structure();
    assert_eq!(written.chunk[..file.buffer.len()], file.buffer, "the old buffer comes first");
    let was = Written::of(&file.glb()).document;
    for key in [
        "asset",
        "scene",
        "scenes",
        "materials",
        "textures",
        "images",
        "skins",
        "animations",
        "cameras",
        "extensions",
        "extras",
    ] {
        assert_eq!(written.document[key], was[key], "{key}");
    }
    for key in ["accessors", "bufferViews"] {
        let (old, new) = (was[key].as_array().unwrap(), written.document[key].as_array().unwrap());
        assert_eq!(new[..old.len()], old[..], "{key}");
    }
    assert_eq!(written.document["buffers"][0]["extras"], "kept");
    let keys = |document: &Value| document.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(keys(&written.document), keys(&was));

    // Nodes stay but for which mesh they show.
    let (old, new) = (was["nodes"].as_array().unwrap(), written.document["nodes"].as_array().unwrap());
    for (old, new) in old.iter().zip(new).filter(|(old, _)| old["name"] != "grove") {
        let without = |node: &Value| {
            let mut node = node.clone();
            node.as_object_mut().unwrap().remove("mesh");
            node
        };
        assert_eq!(without(new), without(old));
    }
    // One keeps the mesh, the other has a copy.
    let shown = |name: &str| new.iter().find(|node| node["name"] == name).unwrap()["mesh"].clone();
    assert_eq!((shown("skinned"), shown("strip")), (json!(0), json!(1)));
    let copy = shown("ball in the tree").as_u64().unwrap() as usize;
    assert!(copy >= was["meshes"].as_array().unwrap().len());
    for (mesh, of) in [(0, 0), (1, 1), (2, 2), (copy, 0)] {
        let (mesh, of) = (&written.document["meshes"][mesh], &was["meshes"][of]);
        for key in ["name", "weights", "extras"] {
            assert_eq!(mesh[key], of[key]);
        }
        for (primitive, of) in
            primitives(&json!({ "meshes": [mesh] })).zip(primitives(&json!({ "meshes": [of] })))
        {
            for key in ["material", "extras", "extensions"] {
                assert_eq!(primitive[key], of[key]);
            }
            if of["mode"] == 0 {
                assert_eq!(primitive, of, "points are left alone");
            }
        }
    }

    // The instances hang where they were one node.
    let grove = new.iter().find(|node| node["name"] == "grove").unwrap();
    assert!(grove.get("mesh").is_none() && grove.get("extensions").is_none(), "{grove}");
    let children = grove["children"].as_array().unwrap();
    assert_eq!(children.len(), 4);
    assert_eq!(children[3], old.iter().find(|node| node["name"] == "grove").unwrap()["children"][0]);
    assert!(children[..3].iter().all(|child| new[child.as_u64().unwrap() as usize]["name"] == "grove"));
    assert_eq!(written.document["extensionsUsed"], json!(["ACME_paint", "KHR_lights_punctual"]));
}

/// That two scenes are the same, and that the second has the atlas of the first.
fn check_same(scene: &Scene, atlas: &Atlas, again: &Scene, name: &str) {
    assert_eq!(again.triangles.len(), scene.triangles.len(), "{name}");
    assert_eq!(again.parts.len(), scene.parts.len(), "{name}");
    let size = Vec2::new(atlas.width as f32, atlas.height as f32);
    for triangle in 0..scene.triangles.len() as u32 {
        assert_eq!(again.corners(triangle), scene.corners(triangle), "{name}: triangle {triangle}");
        let (part, was) = (again.part_of(triangle), scene.part_of(triangle));
        assert_eq!((part.material, part.mirrored), (was.material, was.mirrored), "{name}");
        assert_eq!(again.nodes[part.node as usize].name, scene.nodes[was.node as usize].name);
        for set in 0..2 {
            if was.has_uv[set as usize] {
                assert_eq!(
                    again.corner_uv(triangle, set),
                    scene.corner_uv(triangle, set),
                    "{name}: set {set}"
                );
            }
        }
        if !was.has_uv[1] {
            let places = again.corner_uv(triangle, 1).map(|place| place * size);
            let expected = atlas.corners[triangle as usize];
            assert!(
                places.iter().zip(expected).all(|(a, b)| a.distance(b) < 1e-2),
                "{name}: {places:?} {expected:?}"
            );
        }
        for (a, b) in again.triangles[triangle as usize]
            .vertices
            .into_iter()
            .zip(scene.triangles[triangle as usize].vertices)
        {
            let of = |scene: &Scene, v: u32| {
                (scene.normals.get(v as usize).copied(), scene.colors.get(v as usize).copied())
            };
            assert_eq!(of(again, a), of(scene, b), "{name}");
        }
    }
    let lights = |scene: &Scene| format!("{:?} {:?}", scene.lights, scene.materials);
    assert_eq!(lights(again), lights(scene), "{name}");
    let cameras =
        |scene: &Scene| scene.cameras.iter().map(|c| (c.name.clone(), c.camera_to_world)).collect::<Vec<_>>();
    assert_eq!(cameras(again), cameras(scene), "{name}");
}

fn the_same_scene_reads_back() {
    let (scene, atlas, bytes) = export(&rich());
    assert!(scene.warnings[0].contains("ACME_paint"), "{:?}", scene.warnings);
    assert_eq!(scene.nodes.len(), 6, "{:?}", scene.nodes);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("again.glb");
    std::fs::write(&path, &bytes).unwrap();
    let again = load(&path);
    assert_eq!(again.warnings, scene.warnings);
    check_same(&scene, &atlas, &again, "rich");
}

fn seams_take_all_attributes_along() {
    let file = rich();
    let (.., bytes) = export(&file);
    let (written, was) = (Written::of(&bytes), Written::of(&file.glb()));
    let copy =
        written.document["nodes"].as_array().unwrap().iter().find(|node| node["name"] == "ball in the tree");
    for mesh in [0, copy.unwrap()["mesh"].as_u64().unwrap()] {
        let (old, new) =
            (was.at("/meshes/0/primitives/0"), written.at(&format!("/meshes/{mesh}/primitives/0")));
        assert_ne!(old["attributes"]["POSITION"], new["attributes"]["POSITION"], "a ball has seams");
        assert!(new.get("mode").is_none());
        let [old_corners, corners] = [(&was, old), (&written, new)].map(|(file, primitive)| {
            file.elements(&primitive["indices"]).into_iter().map(whole).collect::<Vec<_>>()
        });
        assert_eq!(old_corners.len(), corners.len());
        for (name, index) in old["attributes"].as_object().unwrap() {
            let anew = &new["attributes"][name];
            let (elements, other) = (was.elements(index), written.elements(anew));
            for (old, new) in old_corners.iter().zip(&corners) {
                assert_eq!(elements[*old as usize], other[*new as usize], "{name}");
            }
            let described = |accessor: &Value| {
                ["componentType", "type", "normalized", "name", "extras"].map(|key| accessor[key].clone())
            };
            assert_eq!(described(was.accessor(index)), described(written.accessor(anew)), "{name}");
            assert_eq!(was.accessor(index)["max"], written.accessor(anew)["max"], "{name}");
        }
        // The sparse deltas are where their vertices are.
        let deltas = written.elements(&new["targets"][0]["POSITION"]);
        for (old, new) in old_corners.iter().zip(&corners) {
            let is_moved = deltas[*new as usize].iter().any(|byte| *byte != 0);
            assert_eq!(is_moved, [1, 7, 20].contains(old), "vertex {old}");
        }
        assert!(new["attributes"].get("TEXCOORD_1").is_some());
    }
}

fn the_set_is_one_that_nobody_uses() {
    let (_, atlas, bytes) = export(&rich());
    let written = Written::of(&bytes);
    let strip = written.at("/meshes/1/primitives/1/attributes");
    let was = rich();
    assert_eq!(strip["TEXCOORD_1"], was.document["meshes"][1]["primitives"][1]["attributes"]["TEXCOORD_1"]);
    let places = written.elements(&strip["TEXCOORD_2"]);
    assert_eq!((places.len(), atlas.corners.is_empty()), (4, false));
    // A leaf has no set at all: the second needs a first.
    let leaf = written.at("/meshes/2/primitives/0/attributes");
    assert!(leaf["TEXCOORD_0"] == leaf["TEXCOORD_1"] && leaf.get("TEXCOORD_2").is_none());
}

fn files_beside_come_along() {
    let file = rich();
    let folder = tempfile::tempdir().unwrap();
    let mut document = file.document.clone();
    // Cut between two views, so that either half is a buffer.
    let views = document["bufferViews"].as_array().unwrap();
    let cut = views[5]["byteOffset"].as_u64().unwrap() as usize;
    let png = &file_of_base64(PNG);
    for view in document["bufferViews"].as_array_mut().unwrap() {
        let offset = view["byteOffset"].as_u64().unwrap() as usize;
        if offset >= cut {
            view["buffer"] = json!(1);
            view["byteOffset"] = json!(offset - cut);
        }
    }
    document["buffers"] = json!([
        { "byteLength": cut, "uri": "a%20b.bin" }, { "byteLength": file.buffer.len() - cut, "uri": "c.bin" },
    ]);
    document["images"][0]["uri"] = json!("dot.png");
    std::fs::write(folder.path().join("a b.bin"), &file.buffer[..cut]).unwrap();
    std::fs::write(folder.path().join("c.bin"), &file.buffer[cut..]).unwrap();
    std::fs::write(folder.path().join("dot.png"), png).unwrap();
    let path = folder.path().join("rich.gltf");
    std::fs::write(&path, document.to_string()).unwrap();
    let scene = load(&path);
    let atlas = unwrap(&scene, &UnwrapOptions { uv: UvPolicy::Ignore, ..UnwrapOptions::default() });
    let elsewhere = tempfile::tempdir().unwrap();
    let out = elsewhere.path().join("out.glb");
    write_glb(&scene, &atlas, &out, &Unwatched).unwrap();
    let written = Written::of(&std::fs::read(&out).unwrap());
    written.check_structure();
    assert_eq!(written.document["buffers"].as_array().unwrap().len(), 1);
    assert_eq!(written.chunk[..file.buffer.len()], file.buffer);
    let image = written.at("/images/0");
    assert_eq!(
        (&image["name"], &image["mimeType"], image.get("uri")),
        (&json!("dot"), &json!("image/png"), None)
    );
    let view = &written.document["bufferViews"][image["bufferView"].as_u64().unwrap() as usize];
    assert_eq!(written.chunk[view["byteOffset"].as_u64().unwrap() as usize..][..png.len()], **png);
    let again = load(&out);
    assert_eq!(again.warnings, scene.warnings);
    check_same(&scene, &atlas, &again, "files beside");
}

fn file_of_base64(text: &str) -> Vec<u8> {
    let digit = |byte: u8| {
        b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/".iter().position(|d| *d == byte)
    };
    let digits: Vec<u32> = text.bytes().map_while(|byte| digit(byte).map(|d| d as u32)).collect();
    let bits =
        |group: &[u32]| group.iter().enumerate().fold(0, |sum, (k, digit)| sum | digit << (18 - 6 * k));
    digits.chunks(4).flat_map(|group| bits(group).to_be_bytes()[1..group.len()].to_vec()).collect()
}

fn every_file_is_written_again() {
    let mut files = Vec::new();
    for folder in ["gltf", "gltf-broken"] {
        gltf_files(&data_folder().join(folder), &mut files);
    }
    if files.is_empty() {
        println!("SKIPPED: no test data at {}", data_folder().display());
    }
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.glb");
    for path in files {
        let Ok(scene) = scene::load(&path, &LoadOptions::default(), &Unwatched) else { continue };
        let child = Some(std::env::current_exe().unwrap());
        let atlas = unwrap(&scene, &UnwrapOptions { child, ..UnwrapOptions::default() });
        let name = path.file_name().unwrap_or_default().display().to_string();
        write_glb(&scene, &atlas, &out, &Unwatched).unwrap_or_else(|error| panic!("{name}: {error}"));
        let again = load(&out);
        println!(
            "  {name}: {} triangles, {} MiB",
            again.triangles.len(),
            out.metadata().unwrap().len() >> 20
        );
        check_same(&scene, &atlas, &again, &name);
        if path.starts_with(data_folder().join("gltf")) {
            Written::of(&std::fs::read(&out).unwrap()).check_structure();
            assert_eq!(again.warnings, scene.warnings, "{name}");
        }
    }
}

fn a_file_that_changed_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rich.glb");
    let mut file = rich();
    std::fs::write(&path, file.glb()).unwrap();
    let scene = load(&path);
    let atlas = unwrap(&scene, &UnwrapOptions::default());
    file.document["nodes"][2]["weights"] = json!([0.75]);
    std::fs::write(&path, file.glb()).unwrap();
    let error = glb_bytes(&scene, &atlas, &Unwatched).unwrap_err();
    assert!(matches!(error, AtlasError::SceneChanged { .. }), "{error}");
    std::fs::remove_file(&path).unwrap();
    let error = glb_bytes(&scene, &atlas, &Unwatched).unwrap_err().to_string();
    assert!(error.contains("rich.glb: cannot be read"), "{error}");
}

fn a_folder_that_is_not_there_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rich.glb");
    std::fs::write(&path, rich().glb()).unwrap();
    let scene = load(&path);
    let atlas = unwrap(&scene, &UnwrapOptions::default());
    let error = write_glb(&scene, &atlas, "/nowhere/at/all/out.glb".as_ref(), &Unwatched).unwrap_err();
    assert!(error.to_string().starts_with("/nowhere/at/all/out.glb: "), "{error}");
}
