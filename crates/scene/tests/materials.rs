//! What a material says beyond its base colour, and along which direction its normal map lies.

mod handmade;

use glam::{DVec2, DVec3, Vec3};
use handmade::Glb;
use scene::{DiffuseTransmission, NormalMap, Scalar, SurfacePoint, Tint, Volume, Workflow};
use serde_json::{Value, json};

const MIDDLE: SurfacePoint = SurfacePoint { triangle: 0, barycentric: DVec2::new(0.3, 0.3) };

/// A triangle whose u runs along x and whose v runs down y, with a texture of these texels.
fn triangle(material: Value, texels: &[[u8; 4]]) -> Glb {
    let mut glb = Glb::triangle();
    glb.texture(texels);
    let uv = glb.accessor(&[0.0, 1.0, 1.0, 1.0, 0.0, 0.0], "VEC2");
    glb.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(uv);
    let names: Vec<String> =
        material["extensions"].as_object().map(|all| all.keys().cloned().collect()).unwrap_or_default();
    glb.paint(material);
    if !names.is_empty() {
        glb.json["extensionsUsed"] = json!(names);
    }
    glb
}

#[test]
fn roughness_is_green_and_metalness_blue_both_linear() {
    let material = json!({"pbrMetallicRoughness": {
        "metallicFactor": 0.5, "roughnessFactor": 1.0, "metallicRoughnessTexture": {"index": 0}}});
    let scene = triangle(material, &[[0, 51, 204, 255]]).clean();
    let Workflow::MetallicRoughness { metallic, roughness } = scene.materials[0].workflow else { panic!() };
    assert!((scene.scalar_at(&metallic, MIDDLE) - 0.4).abs() < 1e-6);
    assert!((scene.scalar_at(&roughness, MIDDLE) - 0.2).abs() < 1e-6);
}

#[test]
fn every_extension_is_read() {
    let material = json!({"extensions": {
        "KHR_materials_ior": {"ior": 1.8},
        "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [2, 1, 0]},
        "KHR_materials_transmission": {"transmissionFactor": 0.75},
        "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0]},
        "KHR_materials_dispersion": {"dispersion": 0.3},
        "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.1,
            "clearcoatNormalTexture": {"index": 0, "scale": 0.5}},
        "KHR_materials_sheen": {"sheenColorFactor": [0.1, 0.2, 0.3], "sheenRoughnessFactor": 0.4},
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.6, "anisotropyRotation": 1.5},
        "KHR_materials_iridescence": {"iridescenceFactor": 1, "iridescenceThicknessMaximum": 300},
        "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.25,
            "diffuseTransmissionColorFactor": [0, 1, 0]}
    }});
    let scene = triangle(material, &[[128, 128, 255, 255]]).clean();
    let material = &scene.materials[0];
    assert_eq!((material.ior, material.dispersion), (1.8, 0.3));
    assert_eq!(material.specular, Scalar::constant(0.5));
    assert_eq!(material.specular_color, Tint::constant(Vec3::new(2.0, 1.0, 0.0)));
    assert_eq!(material.transmission, Scalar::constant(0.75));
    let volume = Volume { attenuation_distance: 2.0, attenuation_color: Vec3::new(1.0, 0.5, 0.0) };
    assert_eq!(material.volume, Some(volume));
    let coat = material.clearcoat.unwrap();
    assert_eq!((coat.factor, coat.roughness), (Scalar::constant(1.0), Scalar::constant(0.1)));
    assert!(matches!(coat.normal_map, Some(NormalMap { scale: 0.5, .. })));
    let sheen = material.sheen.unwrap();
    assert_eq!(
        (sheen.color, sheen.roughness),
        (Tint::constant(Vec3::new(0.1, 0.2, 0.3)), Scalar::constant(0.4))
    );
    let anisotropy = material.anisotropy.unwrap();
    assert_eq!((anisotropy.strength, anisotropy.rotation), (0.6, 1.5));
    let film = material.iridescence.unwrap();
    assert_eq!((film.factor, film.ior, film.thickness), (Scalar::constant(1.0), 1.3, [100.0, 300.0]));
    let through = DiffuseTransmission {
        factor: Scalar::constant(0.25),
        color: Tint::constant(Vec3::new(0.0, 1.0, 0.0)),
    };
    assert_eq!(material.diffuse_transmission, Some(through));
}

#[test]
fn without_thickness_there_is_no_volume_and_without_distance_no_attenuation() {
    let volume = |volume: Value| {
        let material = json!({"extensions": {"KHR_materials_volume": volume}});
        triangle(material, &[[0; 4]]).clean().materials[0].volume
    };
    assert_eq!(volume(json!({"attenuationDistance": 1})), None);
    assert_eq!(volume(json!({"thicknessFactor": 1})).unwrap().attenuation_distance, f64::INFINITY);
}

#[test]
fn faulty_properties_are_reported_and_left_out() {
    for (extension, wrong) in [
        ("KHR_materials_ior", json!({"ior": "glass"})),
        ("KHR_materials_sheen", json!({"sheenColorFactor": [1, 1]})),
        ("KHR_materials_clearcoat", json!({"clearcoatFactor": 1, "clearcoatTexture": {"index": 7}})),
        ("KHR_materials_transmission", json!([])),
        ("KHR_materials_volume", json!({"thicknessFactor": 1, "attenuationDistance": -1})),
    ] {
        let scene = triangle(json!({"extensions": {extension: wrong}}), &[[0; 4]]).load().unwrap();
        assert!(
            scene.warnings.iter().any(|warning| warning.contains(extension)),
            "{extension}: {:?}",
            scene.warnings
        );
        assert_eq!((scene.materials[0].ior, scene.materials[0].transmission.factor), (1.5, 0.0));
    }
}

/// A normal map that leans toward +u or toward +v, by 45°.
const TOWARD_U: [u8; 4] = [218, 128, 218, 255];
const TOWARD_V: [u8; 4] = [128, 218, 218, 255];

fn bumped(glb: &Glb) -> DVec3 {
    let scene = glb.clean();
    let map = scene.materials[0].normal_map.unwrap();
    scene.bumped_normal(&map, MIDDLE)
}

#[test]
fn normal_maps_lean_along_the_texture() {
    let map = || json!({"normalTexture": {"index": 0}});
    let half = 0.5f64.sqrt();
    assert!(bumped(&triangle(map(), &[TOWARD_U])).abs_diff_eq(DVec3::new(half, 0.0, half), 4e-3));
    // Green is upwards in the picture, against v.
    assert!(bumped(&triangle(map(), &[TOWARD_V])).abs_diff_eq(DVec3::new(0.0, half, half), 4e-3));
    let scaled = json!({"normalTexture": {"index": 0, "scale": 0.5}});
    let lean = DVec3::new(0.5, 0.0, 1.0).normalize();
    assert!(bumped(&triangle(scaled, &[TOWARD_U])).abs_diff_eq(lean, 4e-3));
}

#[test]
fn mirrored_textures_and_nodes_mirror_the_normal() {
    let map = json!({"normalTexture": {"index": 0}});
    let half = 0.5f64.sqrt();
    for texel in [TOWARD_U, TOWARD_V] {
        let straight = bumped(&triangle(map.clone(), &[texel]));
        // u runs the other way.
        let mut glb = triangle(map.clone(), &[texel]);
        let uv = glb.accessor(&[1.0, 1.0, 0.0, 1.0, 1.0, 0.0], "VEC2");
        glb.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(uv);
        assert!(bumped(&glb).abs_diff_eq(DVec3::new(-straight.x, straight.y, half), 4e-3), "{texel:?}");
        // A node that mirrors x mirrors the bumps with it; the face stays the front.
        let mut glb = triangle(map.clone(), &[texel]);
        glb.json["nodes"][0]["scale"] = json!([-1, 1, 1]);
        assert!(bumped(&glb).abs_diff_eq(DVec3::new(-straight.x, straight.y, half), 4e-3), "{texel:?}");
        // One that turns everything about x turns the normal.
        let mut glb = triangle(map.clone(), &[texel]);
        glb.json["nodes"][0]["scale"] = json!([1, 1, -1]);
        assert!(bumped(&glb).abs_diff_eq(DVec3::new(straight.x, straight.y, -half), 4e-3), "{texel:?}");
    }
}

#[test]
fn stored_tangents_are_used_and_others_follow_the_transform() {
    let half = 0.5f64.sqrt();
    let mut glb = triangle(json!({"normalTexture": {"index": 0}}), &[TOWARD_U]);
    let tangents = glb.accessor(&[0.0, 1.0, 0.0, 1.0].repeat(3), "VEC4");
    glb.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = json!(tangents);
    assert!(bumped(&glb).abs_diff_eq(DVec3::new(0.0, half, half), 4e-3));
    // A quarter turn from +v to +u: the texture's u runs along −v, which is up.
    let turned = json!({"index": 0, "extensions": {"KHR_texture_transform": {"rotation": std::f32::consts::FRAC_PI_2}}});
    let mut glb = triangle(json!({"normalTexture": turned}), &[TOWARD_U]);
    glb.json["extensionsUsed"] = json!(["KHR_texture_transform"]);
    let found = bumped(&glb);
    assert!(found.x.abs() < 4e-3 && (found.y.abs() - half).abs() < 4e-3, "{found}");
}

#[test]
fn unused_tangents_are_not_stored() {
    let scene = triangle(json!({}), &[[0; 4]]).clean();
    assert!(scene.tangents.is_empty() && scene.images.is_empty());
    // Without texture coordinates there are no tangents, and bumps do nothing.
    let mut glb = triangle(json!({"normalTexture": {"index": 0}}), &[TOWARD_U]);
    glb.json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("TEXCOORD_0");
    let scene = glb.load().unwrap();
    let map = scene.materials[0].normal_map.unwrap();
    assert_eq!(scene.bumped_normal(&map, MIDDLE), DVec3::Z);
}
