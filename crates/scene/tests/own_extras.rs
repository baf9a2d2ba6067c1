//! What of a camera's lens and a material's light stands in `extras` under our key.

mod handmade;

use glam::DVec2;
use handmade::Glb;
use lens::{Aperture, ApertureShape, Camera};
use scene::{CameraLens, ImageLevel, LoadOptions, Scene, load};
use serde_json::{Value, json};

fn with_lens(lens: Value) -> Scene {
    let mut glb = Glb::triangle();
    glb.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}, "extras": {"focus_brush": lens, "other": 3}}]);
    glb.json["nodes"] =
        json!([{"name": "tri", "mesh": 0}, {"name": "shot", "camera": 0, "translation": [0, 0, 5]}]);
    glb.json["scenes"] = json!([{"nodes": [0, 1]}]);
    glb.load().unwrap()
}

#[test]
fn a_lens_is_read_and_missing_fields_have_defaults() {
    let scene = with_lens(json!({
        "version": 1, "width": 300, "height": 200, "focus_distance": "inf", "aperture_radius": 0.01, "sensor_height": 0.016,
        "shift": [0.25, -0.1], "aperture": {"shape": "polygon", "blades": 5, "rotation": 0.2, "ratio": 1.5}
    }));
    let shape = ApertureShape::Polygon { blades: 5, rotation: 0.2, roundness: 0.0 };
    let expected = CameraLens {
        size_px: Some([300, 200]),
        focus_distance: Some(f64::INFINITY),
        aperture_radius: Some(0.01),
        sensor_height: Some(0.016),
        shift: Some(DVec2::new(0.25, -0.1)),
        aperture: Some(Aperture { shape, ratio: 1.5 }),
    };
    assert_eq!(scene.cameras[0].lens, expected);
    assert_eq!(scene.warnings, Vec::<String>::new());
    let some = with_lens(json!({"version": 1, "shift": [0.5, 0]}));
    assert_eq!(some.cameras[0].lens.specified_fields(), ["shift"]);
    let camera = some.cameras[0].lens.apply_to(Camera::default());
    assert_eq!(camera, Camera { shift: DVec2::new(0.5, 0.0), ..Camera::default() });
}

#[test]
fn a_faulty_lens_is_reported_and_left_out() {
    for (lens, place) in [
        (json!(7), "extras/focus_brush"),
        (json!({"aperture_radius": 0.1}), "version: is missing"),
        (json!({"version": 2, "aperture_radius": 0.1}), "version: 2 is not supported"),
        (json!({"version": 1, "aperture_radius": "wide"}), "aperture_radius: is not a number"),
        (json!({"version": 1, "shift": [1]}), "shift: is not an array of 2 numbers"),
        (json!({"version": 1, "focus_distance": -1}), "focus_distance: it must be above 0"),
        (json!({"version": 1, "aperture": {"shape": "star"}}), "star is not a disc"),
        (json!({"version": 1, "aperture": {"shape": "polygon", "blades": 1e9}}), "it must be"),
        (json!({"version": 1, "width": 99999999, "height": 1}), "width: it must be 1 to 16384"),
    ] {
        let scene = with_lens(lens.clone());
        assert_eq!(scene.cameras[0].lens, CameraLens::default(), "{lens}");
        assert!(scene.warnings.iter().any(|told| told.contains(place)), "{lens}: {:?}", scene.warnings);
    }
}

/// A triangle whose material has this radiance, beside a picture of 2 × 1 texels of red 5 and green 0.25.
fn shining(radiance: Value) -> Scene {
    let mut glb = Glb::triangle();
    let uv = glb.accessor(&[0.25, 0.5, 0.25, 0.5, 0.75, 0.5f32], "VEC2");
    let attributes = &mut glb.json["meshes"][0]["primitives"][0];
    attributes["attributes"]["TEXCOORD_0"] = json!(uv);
    attributes["attributes"]["TEXCOORD_1"] = json!(uv);
    attributes["attributes"]["TEXCOORD_2"] = json!(uv);
    attributes["material"] = json!(0);
    glb.json["materials"] = json!([{"name": "lit", "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.1, 0.1, 1]},
        "extras": {"focus_brush": {"version": 1, "radiance": radiance}}}]);
    let folder = tempfile::tempdir().unwrap();
    let texels = [(5.0f32, 0.0f32, -0.5f32), (0.0, 0.25, 0.0)];
    exr::prelude::write_rgb_file(folder.path().join("light.exr"), 2, 1, |x, _| texels[x]).unwrap();
    let file = folder.path().join("scene.glb");
    std::fs::write(&file, glb.bytes()).unwrap();
    load(&file, &LoadOptions::default(), &progress::Unwatched).unwrap()
}

#[test]
fn radiance_of_any_brightness_comes_from_a_picture_beside_the_file() {
    for set in [0, 1, 2] {
        let scene = shining(json!({"uri": "light.exr", "texCoord": set}));
        let material = &scene.materials[0];
        assert!(material.unlit && matches!(scene.images[0].texels, ImageLevel::Float(_)));
        let at = |barycentric: [f64; 2]| {
            scene
                .emitted_radiance(scene::SurfacePoint { triangle: 0, barycentric: barycentric.into() })
                .to_array()
        };
        assert_eq!(at([0.0, 0.0]), [5.0, 0.0, 0.0], "set {set}; light below none is none");
        assert_eq!(at([0.0, 1.0]), [0.0, 0.25, 0.0], "set {set}");
        assert_eq!(at([0.0, 0.5]), [2.5, 0.125, 0.0], "set {set}");
    }
}

#[test]
fn a_picture_of_radiance_lies_in_the_scenes_folder_or_is_left_out() {
    for (radiance, why) in [
        (json!({"uri": "../light.exr"}), "light.exr"),
        (json!({"uri": "/etc/passwd"}), "passwd"),
        (json!({"uri": "none.exr"}), "is missing"),
        (json!({"uri": "scene.glb"}), "not a readable EXR"),
        (json!({"texCoord": 0}), "uri: is missing"),
        (json!("light.exr"), "radiance"),
    ] {
        let scene = shining(radiance.clone());
        assert!(!scene.materials[0].unlit && scene.images.is_empty(), "{radiance}");
        assert!(scene.warnings.iter().any(|told| told.contains(why)), "{radiance}: {:?}", scene.warnings);
    }
}
