//! Textures in any UV set: the one they ask for, and no memory for any other.

mod handmade;

use glam::{Vec2, Vec3, Vec4};
use handmade::{Glb, MIDDLE};
use scene::{LoadOptions, Scene, SurfacePoint, load};
use serde_json::{Value, json};

const RED: Vec4 = Vec4::new(1.0, 0.0, 0.0, 1.0);
const GREEN: Vec4 = Vec4::new(0.0, 1.0, 0.0, 1.0);
const BLUE: Vec4 = Vec4::new(0.0, 0.0, 1.0, 1.0);

/// A triangle whose UV sets 0 to `sets` − 1 all lie on the red texel of its texture.
fn striped(sets: u32, info: Value) -> Glb {
    let mut glb = Glb::triangle();
    let texture = glb.texture(&[[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]]);
    (0..sets).for_each(|set| glb.put_uv(set, 0.125, 0.5));
    let mut info = info;
    info["index"] = json!(texture);
    glb.paint(json!({"pbrMetallicRoughness": {"baseColorTexture": info}}));
    glb.json["extensionsUsed"] = json!(["KHR_texture_transform"]);
    glb
}

fn green(glb: &mut Glb, set: u32) {
    glb.put_uv(set, 0.375, 0.5);
}

#[test]
fn a_texture_uses_the_set_that_it_names() {
    for set in [0, 1, 2, 3, 7, 12] {
        for asks in [
            json!({"texCoord": set}),
            json!({"texCoord": 0, "extensions": {"KHR_texture_transform": {"texCoord": set}}}),
            json!({"texCoord": 1, "extensions": {"KHR_texture_transform": {"texCoord": set}}}),
        ] {
            let mut glb = striped(13, asks.clone());
            assert_eq!(glb.clean().base_color(MIDDLE), RED);
            green(&mut glb, set);
            assert_eq!(glb.clean().base_color(MIDDLE), GREEN, "{asks}");
            assert_eq!(glb.clean().further_uv.len(), usize::from(set > 1), "{asks}");
        }
    }
    // The transform's offset is applied to its own set.
    let mut glb =
        striped(4, json!({"extensions": {"KHR_texture_transform": {"texCoord": 3, "offset": [0.25, 0]}}}));
    green(&mut glb, 3);
    assert_eq!(glb.clean().base_color(MIDDLE), BLUE);
}

#[test]
fn unused_sets_are_not_stored() {
    let mut glb = striped(9, json!({}));
    let scene = glb.clean();
    assert_eq!((scene.further_uv.len(), scene.uv.clone().map(|uv| uv.len())), (0, [3, 3]));
    // Nor what a texture asks for that does not count: without emission there is none.
    glb.json["materials"][0]["emissiveTexture"] = json!({"index": 0, "texCoord": 5});
    assert_eq!(glb.clean().further_uv.len(), 0);
    glb.json["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0, "NORMAL": 1});
    glb.json["materials"] = json!([{}]);
    let scene = glb.load().unwrap();
    assert_eq!((scene.further_uv.len(), scene.uv.map(|uv| uv.len())), (0, [0, 0]));
}

#[test]
fn two_textures_lie_in_two_sets() {
    let mut glb = striped(6, json!({"texCoord": 5}));
    glb.json["materials"][0]["emissiveTexture"] = json!({"index": 0, "texCoord": 2});
    glb.json["materials"][0]["emissiveFactor"] = json!([1, 1, 1]);
    green(&mut glb, 5);
    let scene = glb.clean();
    assert_eq!(
        (scene.base_color(MIDDLE), scene.emitted_radiance(MIDDLE), scene.further_uv.len()),
        (GREEN, Vec3::X, 2)
    );
    // The same set twice is kept once.
    glb.json["materials"][0]["emissiveTexture"]["texCoord"] = json!(5);
    let scene = glb.clean();
    assert_eq!(
        (scene.base_color(MIDDLE), scene.emitted_radiance(MIDDLE), scene.further_uv.len()),
        (GREEN, Vec3::Y, 1)
    );
}

/// Three primitives: one whose material asks for set 3, one for set 2, one for none.
fn mixed() -> Scene {
    let mut glb = striped(4, json!({"texCoord": 3}));
    green(&mut glb, 3);
    let mut second = glb.json["materials"][0].clone();
    second["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = json!(2);
    glb.json["materials"].as_array_mut().unwrap().extend([second, json!({})]);
    let first = glb.json["meshes"][0]["primitives"][0].clone();
    let primitives = [2, 0, 1, 2].map(|material| {
        let mut primitive = first.clone();
        primitive["material"] = json!(material);
        primitive
    });
    glb.json["meshes"][0]["primitives"] = json!(primitives);
    glb.clean()
}

#[test]
fn every_material_has_its_own_sets() {
    let scene = mixed();
    let colors = [0, 1, 2, 3].map(|triangle| scene.base_color(SurfacePoint { triangle, ..MIDDLE }));
    assert_eq!(colors, [Vec4::ONE, GREEN, RED, Vec4::ONE]);
    assert_eq!((scene.further_uv.len(), scene.further_uv[0].len()), (1, scene.positions.len()));
    assert_eq!(scene.corner_uv(1, 2), [Vec2::new(0.375, 0.5); 3]);
}

#[test]
fn a_missing_set_is_zero_with_a_warning() {
    for set in [0, 1, 2, 4_000_000_000u32] {
        let mut glb = striped(0, json!({"texCoord": set}));
        if set != 0 {
            glb.put_uv(0, 0.375, 0.5);
        }
        let scene = glb.load().unwrap();
        // At (0, 0) the first and the last texel meet.
        assert_eq!(scene.base_color(MIDDLE), Vec4::new(1.0, 0.5, 0.5, 1.0), "{set}");
        let told = scene
            .warnings
            .iter()
            .any(|warning| warning.contains(&format!("needs TEXCOORD_{set}, which is missing")));
        assert!(told, "{set}: {:?}", scene.warnings);
    }
}

#[test]
fn further_sets_are_morphed() {
    let mut glb = striped(3, json!({"texCoord": 2}));
    let delta = glb.accessor(&[0.25, 0.0].repeat(3), "VEC2");
    glb.json["meshes"][0]["primitives"][0]["targets"] = json!([{"TEXCOORD_2": delta}]);
    glb.json["meshes"][0]["weights"] = json!([1]);
    assert_eq!(glb.clean().base_color(MIDDLE), GREEN);
}

#[test]
fn further_sets_count_as_memory() {
    let folder = tempfile::TempDir::new().unwrap();
    const VERTICES: usize = 40_000;
    let needed = |set: u32| {
        let mut glb = striped(0, json!({"texCoord": set}));
        let positions = glb.accessor(&[0.5; 3 * VERTICES], "VEC3");
        let uv = glb.accessor(&[0.5; 2 * VERTICES], "VEC2");
        let attributes = json!({"POSITION": positions, "TEXCOORD_0": uv, "TEXCOORD_1": uv, "TEXCOORD_2": uv});
        glb.json["meshes"][0]["primitives"][0]["attributes"] = attributes;
        let file = folder.path().join("large.glb");
        std::fs::write(&file, glb.bytes()).unwrap();
        let opens = |max_memory: u64| {
            let options = LoadOptions { max_memory, memory_per_file_byte: 0, ..LoadOptions::default() };
            load(&file, &options, &progress::Unwatched).is_ok()
        };
        let (mut low, mut high) = (0u64, 1 << 30);
        while high - low > 1000 {
            let middle = (low + high) / 2;
            if opens(middle) { high = middle } else { low = middle }
        }
        high
    };
    // 8 bytes a vertex in the mesh, twice that in the scene, where arrays grow.
    let more = needed(2) - needed(0);
    assert!(more.abs_diff(24 * VERTICES as u64) < 5000, "{more}");
}
