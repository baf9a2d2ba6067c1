//! KHR_materials_pbrSpecularGlossiness: its diffuse colour is the base colour, and its gloss its own.

mod handmade;

use glam::{Vec3, Vec4};
use handmade::{Glb, MIDDLE};
use scene::{AlphaMode, Scalar, Tint, Workflow};
use serde_json::{Value, json};

const NAME: &str = "KHR_materials_pbrSpecularGlossiness";

/// A triangle of this material, whose UVs lie on a grey, half transparent texel (set 0) and an opaque red one (set 2).
fn triangle(material: Value) -> Glb {
    let mut glb = Glb::triangle();
    glb.texture(&[[188, 188, 188, 128], [255, 0, 0, 255]]);
    [0, 1].into_iter().for_each(|set| glb.put_uv(set, 0.25, 0.5));
    glb.put_uv(2, 0.75, 0.5);
    glb.paint(material);
    glb.json["extensionsUsed"] = json!([NAME, "KHR_texture_transform", "KHR_materials_unlit"]);
    glb
}

fn glossy(extension: Value) -> Value {
    json!({"extensions": {NAME: extension}})
}

#[test]
fn diffuse_is_base_colour() {
    let info = json!({"index": 0, "texCoord": 0});
    let second = json!({"index": 0, "extensions": {"KHR_texture_transform": {"texCoord": 2}}});
    let moved = json!({"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0]}}});
    for (factor, texture) in [
        (json!(null), json!(null)),
        (json!([0.5, 0.25, 1, 0.5]), json!(null)),
        (json!(null), info.clone()),
        (json!([0.5, 0.25, 1, 0.5]), info),
        (json!([0.5, 0.5, 0.5, 1]), second),
        (json!([1, 1, 1, 1]), moved),
    ] {
        for mode in ["OPAQUE", "MASK", "BLEND"] {
            let mut given = glossy(json!({"specularFactor": [0, 0, 0], "glossinessFactor": 0}));
            let mut plain = json!({"pbrMetallicRoughness": {"metallicFactor": 0}});
            if !factor.is_null() {
                given["extensions"][NAME]["diffuseFactor"] = factor.clone();
                plain["pbrMetallicRoughness"]["baseColorFactor"] = factor.clone();
            }
            if !texture.is_null() {
                given["extensions"][NAME]["diffuseTexture"] = texture.clone();
                plain["pbrMetallicRoughness"]["baseColorTexture"] = texture.clone();
            }
            given["alphaMode"] = json!(mode);
            plain["alphaMode"] = json!(mode);
            let (scene, expected) = (triangle(given).load().unwrap(), triangle(plain).load().unwrap());
            assert_eq!(scene.base_color(MIDDLE), expected.base_color(MIDDLE), "{factor} {texture}");
            assert_eq!(scene.opacity(MIDDLE), expected.opacity(MIDDLE), "{factor} {texture} {mode}");
            let (material, like) = (&scene.materials[0], &expected.materials[0]);
            let dull = Workflow::SpecularGlossiness {
                specular: Tint::constant(Vec3::ZERO),
                glossiness: Scalar::constant(0.0),
            };
            assert_eq!(material.workflow, dull);
            assert_eq!((material.base_color_texture, material.alpha), (like.base_color_texture, like.alpha));
            assert_eq!(scene.warnings, [""; 0]);
        }
    }
}

#[test]
fn it_may_be_required() {
    let mut glb = triangle(glossy(json!({"diffuseFactor": [1, 0, 0, 1]})));
    glb.json["extensionsRequired"] = json!([NAME]);
    let scene = glb.load().unwrap();
    assert_eq!((scene.base_color(MIDDLE), scene.warnings.len()), (Vec4::new(1.0, 0.0, 0.0, 1.0), 0));
}

#[test]
fn of_both_the_extension_is_preferred_but_for_unlit_ones() {
    let (red, blue, black) = ([1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 0.0, 1.0]);
    let color = |diffuse: [f32; 4], plain: Value, is_unlit: bool| {
        let mut material = glossy(json!({"diffuseFactor": diffuse}));
        material["pbrMetallicRoughness"] = plain;
        if is_unlit {
            material["extensions"]["KHR_materials_unlit"] = json!({});
        }
        triangle(material).load().unwrap().base_color(MIDDLE).to_array()
    };
    assert_eq!(color(red, json!({"baseColorFactor": blue}), false), red);
    assert_eq!(color(black, json!({"baseColorFactor": blue}), false), black);
    assert_eq!(color(red, json!({"baseColorFactor": blue}), true), blue);
    assert_eq!(color(red, json!({}), true), red);
}

#[test]
fn its_texture_scales_colour_and_glossiness() {
    let info = json!({"index": 0, "texCoord": 0});
    let gloss =
        json!({"specularFactor": [1, 0.5, 0], "glossinessFactor": 0.5, "specularGlossinessTexture": info});
    let scene = triangle(glossy(gloss)).clean();
    let Workflow::SpecularGlossiness { specular, glossiness } = scene.materials[0].workflow else {
        panic!("{:?}", scene.materials[0].workflow);
    };
    // sRGB 188 is half the light; opacity is linear.
    assert!(scene.tint_at(&specular, MIDDLE).abs_diff_eq(Vec3::new(0.503, 0.2515, 0.0), 1e-3));
    assert!((scene.scalar_at(&glossiness, MIDDLE) - 0.5 * 128.0 / 255.0).abs() < 1e-6);
}

#[test]
fn gloss_that_is_wrong_is_left_out() {
    for (key, value) in [
        ("specularFactor", json!("much")),
        ("glossinessFactor", json!([])),
        ("specularGlossinessTexture", json!({"index": 99})),
    ] {
        let scene = triangle(glossy(json!({"diffuseFactor": [1, 0, 0, 1], key: value}))).load().unwrap();
        assert_eq!(scene.base_color(MIDDLE), Vec4::new(1.0, 0.0, 0.0, 1.0));
        assert!(scene.warnings.iter().any(|warning| warning.contains(key)), "{key}: {:?}", scene.warnings);
    }
    for (key, value) in [("diffuseFactor", json!([1, 0])), ("diffuseTexture", json!({"index": 99}))] {
        assert!(triangle(glossy(json!({key: value}))).error().contains(key), "{key}");
    }
}

#[test]
fn its_alpha_is_masked() {
    let mut material = glossy(json!({"diffuseTexture": {"index": 0}}));
    material["alphaMode"] = json!("MASK");
    material["alphaCutoff"] = json!(0.25);
    let scene = triangle(material).load().unwrap();
    assert_eq!((scene.materials[0].alpha, scene.opacity(MIDDLE)), (AlphaMode::Mask(0.25), 1.0));
}
