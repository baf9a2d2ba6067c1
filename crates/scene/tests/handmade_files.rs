//! Small files built here: one feature or one attack each.

mod handmade;
mod mutation;

use glam::{DVec3, Vec3, Vec4};
use handmade::{Glb, MIDDLE, load_bytes};
use mutation::{Random, damage};
use progress::{Progress, Unwatched};
use scene::{AlphaMode, LightKind, LoadOptions, MeshHealth, SceneError, inspect, load};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tempfile::TempDir;

#[test]
fn a_triangle() {
    let scene = Glb::triangle().clean();
    assert_eq!(scene.corners(0), [DVec3::ZERO, DVec3::X, DVec3::Y]);
    assert_eq!((scene.nodes[0].name.as_str(), scene.materials[0].name.as_str()), ("tri", "default material"));
    assert_eq!(scene.shading_normal(MIDDLE), DVec3::Z);
    let health = MeshHealth::measure(&scene);
    assert_eq!((health.area, health.boundary_edges, health.without_uv), (0.5, 3, 1));
}

#[test]
fn names_are_the_files_or_numbers() {
    let mut glb = Glb::triangle();
    glb.json["nodes"] = json!([{"children": [1]}, {"mesh": 0}]);
    glb.json["materials"] = json!([{}, {"name": "paint"}]);
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(1);
    let scene = glb.clean();
    assert_eq!((scene.nodes[0].name.as_str(), scene.nodes[0].index), ("node 1", 1));
    assert_eq!(scene.materials.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["material 0", "paint"]);
}

#[test]
fn mirroring_keeps_the_front_in_front() {
    let mut glb = Glb::triangle();
    glb.json["nodes"][0]["scale"] = json!([-2, 1, 1]);
    let scene = glb.clean();
    assert!(scene.parts[0].mirrored);
    assert_eq!(scene.area_normal(0), 2.0 * DVec3::Z);
    assert_eq!(scene.shading_normal(MIDDLE), DVec3::Z);
    // A point reflection turns the front round.
    glb.json["nodes"][0]["scale"] = json!([-1, -1, -1]);
    let scene = glb.clean();
    assert_eq!((scene.area_normal(0), scene.shading_normal(MIDDLE)), (-DVec3::Z, -DVec3::Z));
}

#[test]
fn hierarchies_multiply() {
    let mut glb = Glb::triangle();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    glb.json["nodes"] = json!([
        {"children": [1], "translation": [1, 2, 3], "rotation": [0, 0, half, half]},
        {"mesh": 0, "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 0, 0, 1]}
    ]);
    let expected = [DVec3::new(1.0, 3.0, 3.0), DVec3::new(1.0, 5.0, 3.0), DVec3::new(-1.0, 3.0, 3.0)];
    for (corner, expected) in glb.clean().corners(0).into_iter().zip(expected) {
        assert!(corner.abs_diff_eq(expected, 1e-12), "{corner} {expected}");
    }
}

#[test]
fn instances_are_apart() {
    let mut glb = Glb::triangle();
    let translation = glb.accessor(&[0.0, 0.0, 0.0, 5.0, 0.0, 0.0], "VEC3");
    let rotation = glb.raw_accessor(&[0, 0, 0, 127, 0, 0, 127, 0], 5120, "VEC4", 2);
    glb.json["accessors"][rotation]["normalized"] = json!(true);
    glb.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    glb.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": translation, "ROTATION": rotation}}});
    let scene = glb.clean();
    assert_eq!((scene.nodes.len(), scene.parts.len(), scene.triangles.len()), (2, 2, 2));
    assert_eq!((scene.nodes[1].name.as_str(), scene.parts[1].node), ("tri", 1));
    // Half a turn about z.
    assert!(scene.corners(1)[1].abs_diff_eq(DVec3::new(4.0, 0.0, 0.0), 1e-12));
}

#[test]
fn a_skin_places_its_mesh_and_the_node_does_not() {
    let mut glb = Glb::triangle();
    let joints = glb.raw_accessor(&[0, 1, 0, 0].repeat(3), 5121, "VEC4", 3);
    let weights = glb.accessor(&[0.25, 0.75, 0.0, 0.0].repeat(3), "VEC4");
    let matrix = |x: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, 0.0, 0.0, 1.0];
    let bind = glb.accessor(&[matrix(-1.0), matrix(0.0)].concat(), "MAT4");
    let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    glb.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": bind}]);
    glb.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "translation": [100, 0, 0]},
        {"translation": [1, 0, 0], "children": [2]},
        {"translation": [0, 4, 0]}
    ]);
    glb.json["scenes"][0]["nodes"] = json!([0, 1]);
    // The first joint moves by 1 − 1 = 0, the second by (1, 4, 0), of which three quarters count.
    let scene = glb.clean();
    assert!(scene.corners(0)[0].abs_diff_eq(DVec3::new(0.75, 3.0, 0.0), 1e-12), "{}", scene.corners(0)[0]);
}

#[test]
fn the_nodes_morph_weights_win() {
    let mut glb = Glb::triangle();
    let delta = glb.accessor(&[0.0, 0.0, 1.0].repeat(3), "VEC3");
    glb.json["accessors"][delta]["min"] = json!([0, 0, 1]);
    glb.json["accessors"][delta]["max"] = json!([0, 0, 1]);
    glb.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": delta}]);
    assert_eq!(glb.clean().positions[0].z, 0.0);
    glb.json["meshes"][0]["weights"] = json!([0.5]);
    assert_eq!(glb.clean().positions[0].z, 0.5);
    glb.json["nodes"][0]["weights"] = json!([2]);
    assert_eq!(glb.clean().positions[0].z, 2.0);
}

#[test]
fn vertex_colours_and_alpha_modes() {
    let mut glb = Glb::triangle();
    let colors = glb.raw_accessor(&[255, 0, 51, 51].repeat(3), 5121, "VEC4", 3);
    glb.json["accessors"][colors]["normalized"] = json!(true);
    glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colors);
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    glb.json["materials"] =
        json!([{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1]}, "alphaMode": "BLEND"}]);
    let scene = glb.clean();
    assert!(scene.base_color(MIDDLE).abs_diff_eq(Vec4::new(0.5, 0.0, 0.2, 0.2), 1e-6));
    assert!((scene.opacity(MIDDLE) - 0.2).abs() < 1e-6);
    glb.json["materials"][0]["alphaMode"] = json!("MASK");
    let scene = glb.clean();
    assert_eq!((scene.opacity(MIDDLE), scene.materials[0].alpha), (0.0, AlphaMode::Mask(0.5)));
    glb.json["materials"][0]["alphaCutoff"] = json!(0.1);
    assert_eq!(glb.clean().opacity(MIDDLE), 1.0);
}

#[test]
fn emitted_light() {
    let mut glb = Glb::triangle();
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    glb.json["extensionsUsed"] = json!(["KHR_materials_unlit", "KHR_materials_emissive_strength"]);
    glb.json["materials"] = json!([{"emissiveFactor": [1, 0.5, 0],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}}}]);
    let scene = glb.clean();
    assert_eq!(scene.emitted_radiance(MIDDLE), Vec3::new(4.0, 2.0, 0.0));
    assert!(scene.has_light_sources());
    glb.json["materials"][0]["extensions"] = json!({"KHR_materials_unlit": {}});
    assert_eq!(glb.clean().emitted_radiance(MIDDLE), Vec3::ONE);
}

#[test]
fn lights_shine_down_their_nodes() {
    let mut glb = Glb::triangle();
    glb.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    glb.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "intensity": 3, "color": [1, 0.5, 0], "range": 9, "spot": {"outerConeAngle": 0.5}}]}});
    let half = std::f64::consts::FRAC_1_SQRT_2;
    glb.json["nodes"]
        .as_array_mut()
        .unwrap()
        .push(json!({"translation": [0, 5, 0], "rotation": [-half, 0, 0, half],
        "scale": [3, 3, 3], "extensions": {"KHR_lights_punctual": {"light": 0}}}));
    glb.json["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = glb.clean();
    let light = &scene.lights[0];
    assert_eq!(light.kind, LightKind::Spot { inner: 0.0, outer: 0.5 });
    assert_eq!(
        (light.intensity, light.position, light.range),
        (Vec3::new(3.0, 1.5, 0.0), 5.0 * DVec3::Y, 9.0)
    );
    assert!(light.direction.abs_diff_eq(-DVec3::Y, 1e-12));
}

#[test]
fn a_camera_focuses_on_what_is_ahead() {
    let mut glb = Glb::triangle();
    glb.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]);
    glb.json["nodes"]
        .as_array_mut()
        .unwrap()
        .push(json!({"camera": 0, "translation": [0.2, 0.2, 3], "scale": [2, 2, 2]}));
    glb.json["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = glb.clean();
    assert!((scene.cameras[0].focus_distance - 3.0).abs() < 1e-12);
    assert_eq!(scene.cameras[0].camera_to_world, glam::DMat4::from_translation(DVec3::new(0.2, 0.2, 3.0)));
}

#[test]
fn loops_and_shared_children() {
    let mut glb = Glb::triangle();
    glb.json["nodes"][0]["children"] = json!([0]);
    assert!(glb.error().contains("/nodes/0: is part of a cycle"));
    glb.json["nodes"] = json!([{"children": [2]}, {"children": [2]}, {"mesh": 0}]);
    glb.json["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = glb.load().unwrap();
    assert_eq!(scene.triangles.len(), 1);
    assert!(
        scene.warnings.iter().any(|w| w.contains("/nodes/2: has several parents")),
        "{:?}",
        scene.warnings
    );
    // Doubling at every level would show 2^60 triangles if every path counted.
    let level = |i: usize| json!({"children": [i + 1, i + 1]});
    glb.json["nodes"] = (0..60).map(level).chain([json!({"mesh": 0})]).collect();
    glb.json["scenes"][0]["nodes"] = json!([0]);
    assert_eq!(glb.load().unwrap().triangles.len(), 1);
}

#[test]
fn deep_hierarchies_and_deep_json() {
    let mut glb = Glb::triangle();
    let link = |i: usize| json!({"children": [i + 1], "translation": [0, 0, 0.5]});
    glb.json["nodes"] = (0..50_000).map(link).chain([json!({"mesh": 0})]).collect();
    assert_eq!(glb.load().unwrap().positions[0].z, 25_000.0);
    let deep = "[".repeat(1_000_000);
    assert!(
        load_bytes(deep.as_bytes(), &LoadOptions::default()).unwrap_err().to_string().contains("not a glTF")
    );
    let deep = format!("{{\"asset\":{}", "{\"a\":".repeat(100_000));
    assert!(
        load_bytes(deep.as_bytes(), &LoadOptions::default()).unwrap_err().to_string().contains("recursion")
    );
}

#[test]
fn absurd_counts() {
    for (accessor, what) in [
        (
            json!({"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4_000_000_000u64}),
            "do not fit",
        ),
        (
            json!({"componentType": 5126, "type": "VEC3", "count": 4_000_000_000u64}),
            "more than 20000000 triangles",
        ),
        (json!({"componentType": 5126, "type": "VEC3", "count": 1e300}), "is not a whole number"),
        (
            json!({"bufferView": 0, "byteOffset": u64::MAX, "componentType": 5126, "type": "VEC3", "count": 3}),
            "do not fit",
        ),
    ] {
        let mut glb = Glb::triangle();
        glb.json["accessors"][0] = accessor;
        let start = Instant::now();
        let error = glb.error();
        assert!(error.contains(what), "{error}");
        assert!(start.elapsed() < Duration::from_secs(1));
    }
    let mut glb = Glb::triangle();
    let translation = glb.accessor(&[0.0; 3], "VEC3");
    glb.json["accessors"][translation] =
        json!({"componentType": 5126, "type": "VEC3", "count": 4_000_000_000u64});
    glb.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": translation}}});
    assert!(glb.error().contains("too many steps"), "{}", glb.error());
    glb.json["accessors"][translation]["count"] = json!(6_000_000);
    assert!(glb.error().contains("limit"), "{}", glb.error());
}

#[test]
fn many_primitives_of_one_accessor_stay_small_and_quick() {
    // A million vertices, used by a thousand primitives of one triangle each.
    let mut glb = Glb::triangle();
    let positions = glb.accessor(&vec![0.5; 3_000_000], "VEC3");
    let primitives: Vec<Value> = (0..1000u32)
        .map(|i| {
            let corners = [i, 500_000 + i, 999_999 - i];
            let bytes: Vec<u8> = corners.iter().flat_map(|v| v.to_le_bytes()).collect();
            let indices = glb.raw_accessor(&bytes, 5125, "SCALAR", 3);
            json!({"attributes": {"POSITION": positions}, "indices": indices})
        })
        .collect();
    glb.json["meshes"][0]["primitives"] = json!(primitives);
    let start = Instant::now();
    let scene = glb.load().unwrap();
    assert_eq!((scene.positions.len(), scene.triangles.len()), (3000, 1000));
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
}

#[test]
fn triangles_that_cannot_be_are_left_out() {
    let mut glb = Glb::triangle();
    let indices = glb.raw_accessor(&[0, 1, 2, 0, 1, 9, 0, 1, 2], 5121, "SCALAR", 9);
    glb.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    let scene = glb.load().unwrap();
    assert_eq!((scene.triangles.len(), MeshHealth::measure(&scene).duplicates), (2, 1));
    assert!(
        scene.warnings[0].contains("1 of 3 triangles refer to vertices beyond the 3"),
        "{:?}",
        scene.warnings
    );
    let mut glb = Glb::triangle();
    let nan = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, f32::NAN, 1.0, 0.0];
    let positions = glb.accessor(&nan, "VEC3");
    glb.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(positions);
    assert!(matches!(glb.load(), Err(SceneError::NoTriangles { .. })), "{}", glb.error());
}

#[test]
fn required_extensions() {
    let mut glb = Glb::triangle();
    glb.json["extensionsUsed"] = json!(["FB_unheard_of"]);
    let scene = glb.load().unwrap();
    assert!(scene.warnings[0].contains("FB_unheard_of is ignored"), "{:?}", scene.warnings);
    glb.json["extensionsRequired"] = json!(["FB_unheard_of"]);
    let error = glb.error();
    assert!(
        error.contains("requires the extension FB_unheard_of") && error.contains("without it"),
        "{error}"
    );
}

#[test]
fn a_file_of_points_can_only_be_inspected() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("points.glb");
    let mut glb = Glb::triangle();
    glb.json["meshes"][0]["primitives"][0]["mode"] = json!(0);
    std::fs::write(&file, glb.bytes()).unwrap();
    let error = load(&file, &LoadOptions::default(), &Unwatched).unwrap_err();
    assert!(
        matches!(error, SceneError::NoTriangles { .. }) && error.to_string().contains("points.glb"),
        "{error}"
    );
    let inspection = inspect(&file, &LoadOptions::default()).unwrap();
    assert_eq!((inspection.primitives[0], inspection.triangles), (1, 0));
}

/// A scene in `folder/inner/scene.gltf` whose positions come from `uri`.
fn scene_with_buffer(folder: &Path, uri: &str) -> PathBuf {
    let mut glb = Glb::triangle();
    glb.json["buffers"][0]["uri"] = json!(uri);
    let inner = folder.join("inner");
    std::fs::create_dir_all(&inner).unwrap();
    for name in ["outside.bin", "inner/the buffer.bin"] {
        std::fs::write(folder.join(name), &glb.bin).unwrap();
    }
    let file = inner.join("scene.gltf");
    std::fs::write(&file, glb.json.to_string()).unwrap();
    file
}

#[test]
fn files_outside_the_folder_are_not_read() {
    let folder = TempDir::new().unwrap();
    let open = |uri: &str| load(&scene_with_buffer(folder.path(), uri), &LoadOptions::default(), &Unwatched);
    assert_eq!(open("the%20buffer.bin").unwrap().triangles.len(), 1);
    let outside = folder.path().join("outside.bin");
    let file_uri = format!("file://{}", outside.display());
    for uri in
        ["../outside.bin", "%2e%2e/outside.bin", "..\\outside.bin", outside.to_str().unwrap(), &file_uri]
    {
        let error = open(uri).unwrap_err().to_string();
        assert!(
            error.contains("/buffers/0/uri") && error.contains("outside the scene's folder"),
            "{uri}: {error}"
        );
    }
    assert!(open("not there.bin").unwrap_err().to_string().contains("is missing"));
    assert!(open(".").unwrap_err().to_string().contains("not"));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&outside, folder.path().join("inner/link.bin")).unwrap();
        assert!(open("link.bin").unwrap_err().to_string().contains("leads outside"));
    }
}

/// A PNG that declares a size and holds nothing.
fn empty_png(width: u32, height: u32) -> Vec<u8> {
    let crc = |bytes: &[u8]| {
        !bytes.iter().fold(!0u32, |crc, &byte| {
            (0..8).fold(
                crc ^ u32::from(byte),
                |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 },
            )
        })
    };
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[8, 6, 0, 0, 0]].concat();
    for (kind, body) in [(b"IHDR", header), (b"IDAT", vec![0x78, 0x9c]), (b"IEND", vec![])] {
        let chunk = [&kind[..], &body].concat();
        png.extend((body.len() as u32).to_be_bytes().iter().chain(&chunk).chain(&crc(&chunk).to_be_bytes()));
    }
    png
}

#[test]
fn images_that_cannot_be_read_are_white() {
    let mut glb = Glb::triangle();
    let uv = glb.accessor(&[0.0; 6], "VEC2");
    let primitive = &mut glb.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["TEXCOORD_0"] = json!(uv);
    primitive["material"] = json!(0);
    glb.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    glb.json["textures"] = json!([{"source": 0}]);
    for (image, what) in [
        (empty_png(60_000, 60_000), "texels"),
        (empty_png(8, 8), "cannot be decoded"),
        (b"GIF89a".to_vec(), "neither PNG, JPEG, WebP nor KTX 2"),
    ] {
        let mut glb = Glb { json: glb.json.clone(), bin: glb.bin.clone() };
        let accessor = glb.raw_accessor(&image, 5121, "SCALAR", 1);
        glb.json["images"] = json!([{"bufferView": accessor, "mimeType": "image/png"}]);
        let scene = glb.load().unwrap();
        assert_eq!(scene.base_color(MIDDLE), Vec4::ONE);
        assert!(
            scene.warnings.iter().any(|w| w.contains("/images/0") && w.contains(what)),
            "{:?}",
            scene.warnings
        );
    }
    glb.json["images"] = json!([{"uri": "absent.png"}]);
    let scene = glb.load().unwrap();
    assert!(scene.warnings[0].contains("absent.png: is missing"), "{:?}", scene.warnings);
}

#[test]
fn limits_and_cancelling() {
    struct Cancelled;
    impl Progress for Cancelled {
        fn report(&self, _: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("a.glb");
    std::fs::write(&file, Glb::triangle().bytes()).unwrap();
    let options = LoadOptions { max_memory: 4096, ..LoadOptions::default() };
    assert!(load(&file, &options, &Unwatched).unwrap_err().to_string().contains("raise the limit"));
    let options = LoadOptions { max_triangles: 0, ..LoadOptions::default() };
    assert!(load(&file, &options, &Unwatched).unwrap_err().to_string().contains("more than 0 triangles"));
    assert!(matches!(load(&file, &LoadOptions::default(), &Cancelled), Err(SceneError::Cancelled(_))));
    assert!(matches!(load(folder.path(), &options, &Unwatched), Err(SceneError::Bad { .. })));
    assert!(matches!(load(&folder.path().join("none"), &options, &Unwatched), Err(SceneError::Bad { .. })));
}

#[test]
fn damaged_bytes_never_panic() {
    let mut glb = Glb::triangle();
    let indices = glb.raw_accessor(&[0, 1, 2, 2, 1, 0], 5121, "SCALAR", 6);
    glb.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    let uv = glb.accessor(&[0.0; 6], "VEC2");
    glb.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(uv);
    glb.json["nodes"][0]["rotation"] = json!([0, 0, 0, 1]);
    let whole = glb.bytes();
    let mut random = Random(7);
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("damaged.glb");
    let mut opened = 0;
    for _ in 0..600 {
        let mut bytes = whole.clone();
        damage(&mut bytes, &mut random);
        std::fs::write(&file, &bytes).unwrap();
        match load(&file, &LoadOptions::default(), &Unwatched) {
            Ok(_) => opened += 1,
            Err(error) => assert!(!error.to_string().contains("the decoder failed"), "{error}"),
        }
    }
    assert!(opened > 20, "{opened}");
}
